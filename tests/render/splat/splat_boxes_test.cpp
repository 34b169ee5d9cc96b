// splat_boxes_test.cpp: Splatting with the paper's bounding boxes against a sum ray by ray.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/splat/splat.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/progress.h"

namespace vog::test {

namespace {

/// Length in t between entering the last slab and leaving the first: > 0 where the ray meets the box.
double overlap(const Box& box, Vec3d origin, Vec3d direction) {
    double enter = 0, leave = HUGE_VAL;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (box.lower[axis] - origin[axis]) / direction[axis];
        const double b = (box.upper[axis] - origin[axis]) / direction[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return leave - enter;
}

Box box_of(const Gaussians& model, std::size_t i, double sigma) {
    // An ellipsoid |W x| <= r reaches r sqrt(C_jj) along axis j, C = (W^T W)^-1 the covariance.
    const Mat3 w = whitening(model, i);
    const Mat3 covariance = inverse(transpose(w) * w);
    Box box;
    const Vec3d mean = vec_cast<double>(model.mean[i]);
    Vec3d half;
    for (int axis = 0; axis < 3; ++axis)
        half[axis] = sigma * std::numbers::sqrt2 * std::sqrt(covariance(axis, axis));
    box.include(mean - half);
    box.include(mean + half);
    return box;
}

/// Compares every pixel with the sum over the Gaussians whose box the ray meets. Pixels whose ray
/// touches the rim of a box are left out: rounding decides there.
void expect_boxed(const Scene& scene, double sigma) {
    constexpr double kRim = 1e-5;  // in t; floats resolve 6e-8 of the distance
    const CameraFrame frame = frame_of(scene.camera, scene.width, scene.height);
    SplatOptions options;
    options.aabb_sigma = sigma;
    const DepthImage image =
        render_splat(scene.model, scene.camera, scene.width, scene.height, options);
    const Box all = view_box(scene.model);
    int compared = 0;
    double largest = 0, worst = 0;
    for (int row = 0; row < scene.height; ++row)
        for (int column = 0; column < scene.width; ++column) {
            const Vec3d direction = frame.direction(column, row);
            double sum = 0;
            bool clear = true;
            for (std::size_t i = 0; i < scene.model.size(); ++i) {
                Box box = box_of(scene.model, i, sigma);
                for (int axis = 0; axis < 3; ++axis) {
                    box.lower[axis] = std::clamp(box.lower[axis], all.lower[axis], all.upper[axis]);
                    box.upper[axis] = std::clamp(box.upper[axis], all.lower[axis], all.upper[axis]);
                }
                const double tau = optical_depth(scene.model, i, frame.eye, direction);
                const double met = overlap(box, frame.eye, direction);
                if (tau > 0 && std::abs(met) < kRim) clear = false;
                if (met > 0) sum += tau;
            }
            if (!clear) continue;
            ++compared;
            largest = std::max(largest, sum);
            worst = std::max(worst, std::abs(sum - double{image.at(column, row)}));
        }
    EXPECT_GT(compared, scene.width * scene.height / 2);
    EXPECT_GT(largest, 0);
    EXPECT_LE(worst, 2e-5 * largest);  // the splat's own tolerance, and sums in another order
}

Scene scene_named(const std::string& name) {
    for (const Scene& scene : scenes())
        if (scene.name == name) return scene;
    throw Error("no scene " + name);
}

}  // namespace

TEST(splat_boxes, one_gaussian_is_cut_to_its_box) {
    for (const double sigma : {0.5, 1.0, 2.0}) expect_boxed(scene_named("one_off_axis"), sigma);
}

TEST(splat_boxes, rotated_gaussians_have_the_box_around_their_ellipsoid) {
    for (const double sigma : {0.5, 1.0}) expect_boxed(scene_named("rotated"), sigma);
}

TEST(splat_boxes, many_gaussians_each_have_their_own_box) {
    Scene scene = scene_named("inside_many");
    for (const double sigma : {1.0, 2.0}) expect_boxed(scene, sigma);
    scene = scene_named("paper_cutoff");
    expect_boxed(scene, 1);
}

TEST(splat_boxes, a_box_around_the_eye_is_met) {
    expect_boxed(scene_named("eye_inside"), 1);
    expect_boxed(scene_named("beside_the_eye"), 1);
}

TEST(splat_boxes, boxes_wider_than_the_support_change_nothing) {
    // Supports reach cutoff / sqrt(2) = 1.6 of the paper's radii; the model's box holds them all.
    // Gaussians of 3 pixels and more: boxes are met by single rays, and no pixel is a mean.
    Scene scene = scene_named("many");
    for (Vec3f& scale : scene.model.scale)
        for (int axis = 0; axis < 3; ++axis) scale[axis] += 0.18f;
    const DepthImage plain = render_splat(scene.model, scene.camera, scene.width, scene.height);
    SplatOptions options;
    options.aabb_sigma = 3;
    const DepthImage boxed =
        render_splat(scene.model, scene.camera, scene.width, scene.height, options);
    const float largest = *std::max_element(plain.depth.begin(), plain.depth.end());
    for (std::size_t n = 0; n < plain.depth.size(); ++n)
        ASSERT_NEAR(boxed.depth[n], plain.depth[n], 1e-4f * largest) << "pixel " << n;
}

TEST(splat_boxes, the_models_box_bounds_every_box) {
    Gaussians model;
    add(model, {0, 0, 0}, {0.5f, 0.5f, 0.5f}, 1);
    model.box = {{0, -2, -2}, {2, 2, 2}};  // the half right of the middle
    Camera camera;
    camera.eye = {0, 0, 5};
    camera.fov_degrees = 40;
    SplatOptions options;
    options.aabb_sigma = 3;
    const DepthImage image = render_splat(model, camera, 64, 64, options);
    EXPECT_EQ(image.at(26, 32), 0);
    EXPECT_GT(image.at(37, 32), 0);
}

TEST(splat_boxes, same_bytes_for_any_number_of_threads) {
    const Scene scene = scene_named("many");
    SplatOptions options;
    options.aabb_sigma = 1;
    const auto render = [&] {
        return render_splat(scene.model, scene.camera, scene.width, scene.height, options).depth;
    };
    const std::vector<float> many = render();
    const ThreadLimit limit(1);
    EXPECT_EQ(render(), many);
}

TEST(splat_boxes, negative_or_non_finite_sigma_throws) {
    SplatOptions options;
    for (const double sigma : {-1.0, std::nan(""), HUGE_VAL}) {
        options.aabb_sigma = sigma;
        EXPECT_THROW((void)render_splat(Gaussians{}, Camera{}, 8, 8, options), Error) << sigma;
    }
}

}  // namespace vog::test
