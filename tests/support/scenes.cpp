// scenes.cpp: scenes for the renderers' tests.
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "render/ray_gaussian.h"
#include "support/pixel_mean.h"

namespace vog::test {

double Random::operator()() {
    // splitmix64: Steele, Lea & Flood 2014.
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

Vec3d Random::in_cube(double half_edge) {
    const double x = (*this)(-half_edge, half_edge), y = (*this)(-half_edge, half_edge);
    return {x, y, (*this)(-half_edge, half_edge)};
}

Quat Random::rotation() {
    // Rejection sampling from the cube gives uniform rotations.
    while (true) {
        const double w = (*this)(-1, 1);
        const Vec3d v = in_cube(1);
        const double norm2 = w * w + dot(v, v);
        if (norm2 > 1 || norm2 < 0.01) continue;
        const double s = 1 / std::sqrt(norm2);
        return {float(w * s), float(v.x * s), float(v.y * s), float(v.z * s)};
    }
}

void add(Gaussians& model, Vec3f mean, Vec3f scale, float density, Quat rotation) {
    if (!(rotation == Quat{}) || !model.axis_aligned()) {
        model.rotation.resize(model.size());
        model.rotation.push_back(rotation);
    }
    model.mean.push_back(mean);
    model.scale.push_back(scale);
    model.density.push_back(density);
}

Gaussians random_gaussians(int count, double low, double high, std::uint64_t seed, float cutoff) {
    Random random(seed);
    Gaussians model;
    model.cutoff = cutoff;
    for (int i = 0; i < count; ++i) {
        const Vec3d mean = random.in_cube(1);
        const double sx = random(low, high), sy = random(low, high), sz = random(low, high);
        const double density = 1 - random();
        add(model, vec_cast<float>(mean), {float(sx), float(sy), float(sz)}, float(density),
            random.rotation());
    }
    return model;
}

namespace {

Camera camera_at(Vec3d eye, double fov_degrees, Vec3d look_at = {}) {
    Camera camera;
    camera.eye = eye;
    camera.look_at = look_at;
    camera.fov_degrees = fov_degrees;
    return camera;
}

Gaussians one(Vec3f mean, Vec3f scale, float density = 1, Quat rotation = {},
              float cutoff = 2.25f) {
    Gaussians model;
    model.cutoff = cutoff;
    add(model, mean, scale, density, rotation);
    return model;
}

/// The same model and camera in another world unit.
Scene scaled(Scene scene, const std::string& name, double factor) {
    scene.name = name;
    const auto scale = [&](Vec3f& v) { v = vec_cast<float>(factor * vec_cast<double>(v)); };
    for (Vec3f& v : scene.model.mean) scale(v);
    for (Vec3f& v : scene.model.scale) scale(v);
    for (float& density : scene.model.density) density = static_cast<float>(density / factor);
    scene.camera.eye = factor * scene.camera.eye;
    scene.camera.look_at = factor * scene.camera.look_at;
    scene.camera.orthographic_width *= factor;
    return scene;
}

/// Gaussians along z that overlap their neighbours.
Gaussians on_one_ray(int count) {
    Random random(14);
    Gaussians model;
    for (int i = 0; i < count; ++i)
        add(model, {0, 0, static_cast<float>(random(-2, 2))}, {0.2f, 0.2f, 0.1f}, 1e-3f);
    return model;
}

/// Gaussians that all contain the origin: segments start at the eye.
Gaussians all_around(int count) {
    Random random(15);
    Gaussians model;
    for (int i = 0; i < count; ++i)
        add(model, vec_cast<float>(random.in_cube(0.5)), {0.6f, 0.7f, 0.5f}, 1e-3f,
            random.rotation());
    return model;
}

/// Spheres with touching boxes whose faces are in the axes' planes: rays along an axis are within
/// faces and edges.
Gaussians on_a_grid() {
    Gaussians model;
    model.cutoff = 2;
    for (int x = -2; x < 2; ++x)
        for (int y = -2; y < 2; ++y)
            for (int z = -2; z < 2; ++z)
                add(model,
                    {0.5f * float(x) + 0.25f, 0.5f * float(y) + 0.25f, 0.5f * float(z) + 0.25f},
                    {0.125f, 0.125f, 0.125f}, 1);
    add(model, {0, 0, 0}, {0.25f, 0.25f, 0.25f}, 1);
    return model;
}

Gaussians moved(Gaussians model, float distance) {
    for (Vec3f& mean : model.mean) mean.x += distance;
    return model;
}

/// The scene moved to a place where floats are 8 units apart.
Scene at_an_origin(Scene scene, const std::string& name) {
    scene.name = name;
    scene.model.origin = {5000000.1, -3e7, 1e8};
    scene.camera.eye = scene.camera.eye + scene.model.origin;
    scene.camera.look_at = scene.camera.look_at + scene.model.origin;
    return scene;
}

}  // namespace

std::vector<Scene> scenes() {
    const Camera front = camera_at({0, 0, 5}, 40);
    const Quat tilted{0.8f, 0.3f, -0.4f, 0.33f};
    std::vector<Scene> all;
    all.push_back({"one_on_axis", one({0, 0, 0}, {0.5f, 0.5f, 0.5f}), front, 65, 65});
    all.push_back({"one_off_axis", one({0.9f, -0.7f, 0}, {0.3f, 0.2f, 0.5f}), front, 64, 48});
    all.push_back({"rotated", one({0.2f, 0.1f, 0}, {0.6f, 0.2f, 0.1f}, 2, tilted), front, 64, 64});
    all.push_back({"needle", one({0, 0, 0}, {1.5f, 0.01f, 0.01f}, 5, tilted), front, 128, 128});
    all.push_back({"disc_edge_on", one({0, 0, 0}, {0.005f, 0.8f, 0.8f}, 5, {0.99f, 0, 0.14f, 0}),
                   front, 128, 128});
    all.push_back(
        {"eye_inside", one({0, 0, 0}, {1, 2, 1.5f}, 1, tilted), camera_at({0.3, 0.2, 0.4}, 60)});
    all.push_back({"eye_at_mean", one({0, 0, 0}, {1, 1, 1}), camera_at({0, 0, 0}, 90, {0, 0, -1})});
    all.push_back({"eye_just_outside", one({0, 0, 0}, {1, 1, 1}), camera_at({0, 0, 2.26}, 90)});
    all.push_back({"eye_on_support", one({0, 0, 0}, {1, 1, 1}), camera_at({0, 0, 2.25}, 120)});
    all.push_back({"beside_the_eye", one({2, 0, 0}, {0.8f, 0.8f, 0.8f}),
                   camera_at({0, 0, 0}, 150, {0, 0, -1})});
    all.push_back({"behind", one({0, 0, 9}, {1, 1, 1}), front});
    all.push_back(
        {"wide_angle", random_gaussians(300, 0.02, 0.2, 3), camera_at({0, 0, 1.6}, 150), 96, 96});
    all.push_back(
        {"inside_many", random_gaussians(400, 0.05, 0.3, 4), camera_at({0.1, 0, 0.2}, 75), 64, 48});
    // One Gaussian per pixel, thousands at its rim, where tau falls like sqrt(u): rounding of u by
    // 1e-6 changes tau by up to 1e-4 of the peak, typically 1e-5.
    all.push_back({"sub_pixel", random_gaussians(4000, 0.0005, 0.003, 5), front, 80, 80, 3e-5});
    all.push_back({"many", random_gaussians(3000, 0.01, 0.1, 6), front, 72, 40});
    all.push_back({"ten_thousand", random_gaussians(10000, 0.01, 0.1, 12), front, 32, 32});
    all.push_back({"paper_cutoff", random_gaussians(300, 0.05, 0.2, 7, 3.0349f), front});
    all.push_back({"wide_cutoff", random_gaussians(100, 0.05, 0.2, 8, 6.0f), front});
    all.push_back({"narrow_cutoff", random_gaussians(100, 0.05, 0.3, 9, 0.5f), front});
    all.push_back({"far_away", random_gaussians(50, 0.02, 0.2, 10), camera_at({0, 0, 2000}, 0.07)});
    all.push_back(scaled(all[14], "centimetres_of_a_galaxy", 1e24));
    all.push_back(scaled(all[14], "metres_of_an_atom", 1e-10));
    all.push_back({"one_pixel", one({0, 0, 0}, {0.5f, 0.5f, 0.5f}), front, 1, 1});
    all.push_back({"empty", Gaussians{}, front, 17, 5});
    Camera rolled = front;
    rolled.up = {1, 2, 0.5};
    // Rounding of a sum of 10,000 floats: about 1e-5.
    all.push_back({"on_one_ray", on_one_ray(10000), front, 5, 5, 3e-5});
    all.push_back({"around_the_eye", all_around(300), camera_at({0, 0, 0}, 70, {1, 0, 0}), 18, 14});
    all.push_back({"along_axes", on_a_grid(), camera_at({0, 0, 5}, 40), 41, 41});
    all.push_back({"along_axes_inside", on_a_grid(), camera_at({0, 0, 0}, 90, {-1, 0, 0}), 41, 41});
    all.push_back({"flat", one({0, 0, 0}, {0.5f, 0.4f, 1e-6f}, 1e6f), front, 33, 33});
    all.push_back(
        {"flat_tilted", one({0, 0, 0}, {0.5f, 1e-6f, 0.4f}, 1e6f, tilted), front, 33, 33});
    all.push_back({"far_from_the_origin", moved(random_gaussians(300, 0.05, 0.2, 13), 4096),
                   camera_at({4096, 0, 5}, 40, {4096, 0, 0})});
    all.push_back(at_an_origin(all[12], "inside_at_an_origin"));
    all.push_back(at_an_origin(all[14], "many_at_an_origin"));
    // Parallel rays, from outside, through the middle, beside the data, of every cutoff.
    const auto parallel = [&](Camera camera, double width) {
        camera.orthographic_width = width;
        return camera;
    };
    all.push_back({"parallel_many", random_gaussians(3000, 0.01, 0.1, 6),
                   parallel(camera_at({1, 2, 5}, 40), 2.5), 72, 40});
    all.push_back({"parallel_needle", one({0, 0, 0}, {1.5f, 0.01f, 0.01f}, 5, tilted),
                   parallel(front, 4), 128, 128});
    all.push_back({"parallel_disc_edge_on",
                   one({0, 0, 0}, {0.005f, 0.8f, 0.8f}, 5, {0.99f, 0, 0.14f, 0}),
                   parallel(front, 3), 128, 128});
    all.push_back({"parallel_through_many", random_gaussians(400, 0.05, 0.3, 4),
                   parallel(camera_at({0.1, 0, 0.2}, 75), 1.5), 64, 48});
    all.push_back({"parallel_beside", random_gaussians(400, 0.05, 0.3, 4),
                   parallel(camera_at({1.2, 0.7, 3}, 40, {1.2, 0.7, 0}), 0.8), 32, 48});
    all.push_back({"parallel_paper_cutoff", random_gaussians(300, 0.05, 0.2, 7, 3.0349f),
                   parallel(camera_at({-3, 1, 0.5}, 40), 2)});
    all.push_back(at_an_origin(all.back(), "parallel_at_an_origin"));
    all.push_back({"parallel_far_eye", random_gaussians(50, 0.02, 0.2, 10),
                   parallel(camera_at({0, 300, 2000}, 40), 2.5)});
    all.push_back(scaled(all.back(), "parallel_centimetres", 1e24));
    all.push_back({"parallel_along_axes", on_a_grid(), parallel(front, 3), 41, 41});
    all.push_back({"rolled_camera", random_gaussians(200, 0.02, 0.3, 11), rolled, 50, 70});
    return all;
}

std::vector<double> exact_depth(const Scene& scene) {
    const CameraFrame frame = frame_of(scene.camera, scene.width, scene.height);
    std::vector<PixelMean> drawn;
    std::vector<Vec3d> mean;
    for (std::size_t i = 0; i < scene.model.size(); ++i) {
        drawn.push_back(pixel_mean(scene.model, i, frame));
        mean.push_back(world_mean(scene.model, i));
    }
    std::vector<double> depth(static_cast<std::size_t>(scene.width) *
                              static_cast<std::size_t>(scene.height));
    const auto fill_row = [&](int row) {
        for (int column = 0; column < scene.width; ++column) {
            const Vec3d direction = normalized(frame.direction(column, row));
            const Vec3d origin = frame.origin(column, row);
            double sum = 0;
            for (std::size_t i = 0; i < drawn.size(); ++i)
                sum +=
                    drawn[i].density * segment_integral(drawn[i].w * (mean[i] - origin),
                                                        drawn[i].w * direction, scene.model.cutoff);
            depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(scene.width) +
                  static_cast<std::size_t>(column)] = sum;
        }
    };
    // std::thread, because the GPU suite builds this file without TBB.
    const int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    std::vector<std::thread> pool;
    for (int first = 0; first < threads; ++first)
        pool.emplace_back([&, first] {
            for (int row = first; row < scene.height; row += threads) fill_row(row);
        });
    for (std::thread& thread : pool) thread.join();
    return depth;
}

}  // namespace vog::test
