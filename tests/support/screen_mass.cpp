// screen_mass.cpp: sums over pictures of Gaussians below and around a pixel.
#include "support/screen_mass.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/scenes.h"

namespace vog::test {

namespace {

/// Sum over the model of mass (pixels_per_unit / z)^2.
double expected_sum(const Gaussians& model, const Camera& camera, int size) {
    const CameraFrame frame = frame_of(camera, size, size);
    double sum = 0;
    for (std::size_t i = 0; i < model.size(); ++i) {
        const Vec3d p = vec_cast<double>(model.mean[i]) - frame.eye;
        const double per_unit = frame.pixels_per_unit / dot(p, frame.forward);
        sum += mass(model, i) * per_unit * per_unit;
    }
    return sum;
}

Camera far_camera() {
    Camera camera;
    camera.eye = {0, 0, 100};
    camera.fov_degrees = 20;
    return camera;
}

}  // namespace

double screen_sum(const DepthImage& image, const Camera& camera) {
    const CameraFrame frame = frame_of(camera, image.width, image.height);
    double sum = 0;
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column)
            sum += double{image.at(column, row)} / length(frame.direction(column, row));
    return sum;
}

void expect_mass_of_particles(const PictureOf& render, int size) {
    const Gaussians model = random_gaussians(65536, 1e-4, 1.7e-4, 61);
    Camera camera = paper_view({{-1, -1, -1}, {1, 1, 1}});
    for (const double moved : {0.0, 0.0007, 0.0031}) {
        SCOPED_TRACE(testing::Message() << size << ", moved by " << moved);
        camera.eye.x += moved, camera.look_at.y += moved;
        const double expected = expected_sum(model, camera, size);
        EXPECT_NEAR(screen_sum(render(model, camera, size, size), camera), expected,
                    0.005 * expected);
    }
}

void expect_mass_of_one(const PictureOf& render) {
    constexpr int kSize = 48;
    const Camera camera = far_camera();
    const double pixel = 100 / frame_of(camera, kSize, kSize).pixels_per_unit;
    for (const float cutoff : {2.25f, 3.0349f, 1.0f, 6.0f})
        for (const double deviation : {0.01, 0.3, 0.6, 0.8, 1.1, 1.55, 2.0, 2.2, 3.0}) {
            // The edge of a narrow kernel is steep: 6 % at k = 1 and 3 pixels.
            if (cutoff < 2 && deviation > 2) continue;
            for (int place = 0; place < 25; ++place) {
                Gaussians model;
                model.cutoff = cutoff;
                const auto scale = static_cast<float>(deviation * pixel);
                add(model,
                    {static_cast<float>((3 + 0.13 * (place % 5)) * pixel),
                     static_cast<float>((-2 + 0.13 * (place / 5)) * pixel), 0},
                    {scale, scale, scale}, 1);
                const double expected = expected_sum(model, camera, kSize);
                ASSERT_NEAR(screen_sum(render(model, camera, kSize, kSize), camera), expected,
                            0.005 * expected)
                    << "cutoff " << cutoff << ", " << deviation << " pixels, place " << place;
            }
        }
}

void expect_mass_of_thin_ones(const PictureOf& render) {
    constexpr int kSize = 96;
    const Camera camera = far_camera();
    const double pixel = 100 / frame_of(camera, kSize, kSize).pixels_per_unit;
    Random random(62);
    double shown = 0, of_all = 0;
    for (const bool disc : {false, true})
        for (int n = 0; n < 40; ++n) {
            const auto thin = static_cast<float>(0.02 * pixel),
                       wide = static_cast<float>(8 * pixel);
            Gaussians model;
            add(model, vec_cast<float>(random.in_cube(pixel)), {wide, disc ? wide : thin, thin}, 1,
                random.rotation());
            const double expected = expected_sum(model, camera, kSize);
            const double sum = screen_sum(render(model, camera, kSize, kSize), camera);
            ASSERT_NEAR(sum, expected, 0.025 * expected) << (disc ? "disc " : "needle ") << n;
            shown += sum / expected, of_all += 1;
        }
    EXPECT_NEAR(shown, of_all, 0.005 * of_all);
}

}  // namespace vog::test
