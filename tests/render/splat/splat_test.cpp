// splat_test.cpp: The splat renderer: reuse without allocation, every scale of Gaussian, options, and
// invalid input.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "render/ray_gaussian.h"
#include "render/splat/splat.h"
#include "support/allocations.h"
#include "support/pixel_mean.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/progress.h"

namespace vog::test {

namespace {

const Camera kView = paper_view({{-1, -1, -1}, {1, 1, 1}});

/// Expects a picture's definition within 1e-4 of the largest T at every `step`-th pixel.
void expect_exact(const Gaussians& model, const DepthImage& image, int step) {
    const CameraFrame frame = frame_of(kView, image.width, image.height);
    std::vector<PixelMean> drawn;
    for (std::size_t i = 0; i < model.size(); ++i) drawn.push_back(pixel_mean(model, i, frame));
    const double largest = *std::max_element(image.depth.begin(), image.depth.end());
    EXPECT_GT(largest, 0);
    for (int row = 0; row < image.height; row += step)
        for (int column = 0; column < image.width; column += step) {
            const Vec3d direction = normalized(frame.direction(column, row));
            double exact = 0;
            for (std::size_t i = 0; i < drawn.size(); ++i)
                exact +=
                    drawn[i].density *
                    segment_integral(drawn[i].w * (vec_cast<double>(model.mean[i]) - frame.eye),
                                     drawn[i].w * direction, model.cutoff);
            ASSERT_NEAR(image.at(column, row), exact, 1e-4 * largest) << column << ' ' << row;
        }
}

}  // namespace

TEST(splat_renderer, a_frame_like_the_one_before_allocates_nothing) {
    if (allocations() < 0) GTEST_SKIP() << "the address sanitizer's operator new does not count";
    // Rotated Gaussians of every size, some of them around the eye.
    Gaussians model = random_gaussians(20000, 0.002, 0.05, 41);
    append(model, random_gaussians(40, 0.3, 2, 42));
    SplatRenderer renderer(model);
    DepthImage image;
    renderer.render(kView, 300, 200, image);
    const std::vector<float> first = image.depth;
    const long before = allocations();
    for (int frame = 0; frame < 3; ++frame) renderer.render(kView, 300, 200, image);
    EXPECT_EQ(allocations() - before, 0);
    EXPECT_EQ(image.depth, first);
}

TEST(splat_renderer, nothing_of_a_frame_is_left_in_the_next) {
    const Gaussians model = random_gaussians(3000, 0.01, 0.3, 43);
    SplatRenderer renderer(model);
    Camera inside = kView;
    inside.eye = {0.1, 0.2, 0.1};
    DepthImage image;
    for (const auto& [camera, width, height] :
         {std::tuple(kView, 320, 240), std::tuple(inside, 65, 33), std::tuple(kView, 1, 1),
          std::tuple(inside, 320, 240), std::tuple(kView, 700, 90)}) {
        renderer.render(camera, width, height, image);
        const DepthImage fresh = render_splat(model, camera, width, height);
        ASSERT_EQ(image.width, width);
        ASSERT_EQ(image.height, height);
        EXPECT_EQ(image.depth, fresh.depth);
    }
}

TEST(splat_renderer, tiles_that_nothing_touches_become_zero) {
    Gaussians model;
    add(model, {0, 0, 0}, {0.02f, 0.02f, 0.02f}, 1);
    SplatRenderer renderer(model);
    DepthImage image(500, 400);
    std::fill(image.depth.begin(), image.depth.end(), 7.0f);
    renderer.render(kView, 500, 400, image);
    EXPECT_EQ(image.at(0, 0), 0);
    EXPECT_EQ(image.at(499, 399), 0);
    EXPECT_GT(image.at(250, 200), 0);
}

TEST(splat_renderer, one_gaussian_over_the_whole_screen_is_exact) {
    Gaussians model;
    add(model, {0.1f, 0, 0}, {0.9f, 0.7f, 0.8f}, 2, {0.8f, 0.3f, -0.4f, 0.33f});
    for (const std::string& target : splat_targets()) {
        SCOPED_TRACE(target);
        const DepthImage image = render_splat(model, kView, 1920, 1080, {.simd_target = target});
        expect_exact(model, image, 37);
    }
}

TEST(splat_renderer, wide_and_narrow_gaussians_together_are_exact) {
    // Some touch more tiles than are binned, some one pixel.
    Gaussians model = random_gaussians(50, 0.1, 0.4, 44);
    append(model, random_gaussians(500, 0.0005, 0.01, 45));
    for (const std::string& target : splat_targets()) {
        SCOPED_TRACE(target);
        const DepthImage image = render_splat(model, kView, 1000, 700, {.simd_target = target});
        expect_exact(model, image, 41);
    }
}

TEST(splat_renderer, widths_around_every_block_of_a_vector_are_exact) {
    // Discs of 1 to 40 pixels, so that every shape of block is used, in tiles' corners too.
    Gaussians model;
    for (int n = 0; n < 40; ++n)
        add(model, {float(-0.8 + 0.2 * (n % 8)), float(-0.5 + 0.25 * (n / 8)), 0},
            {float(0.0008 * (n + 1)), float(0.0006 * (n + 1)), 0.01f}, 1);
    for (const std::string& target : splat_targets()) {
        SCOPED_TRACE(target);
        const DepthImage image = render_splat(model, kView, 640, 480, {.simd_target = target});
        expect_exact(model, image, 3);
    }
}

TEST(splat_renderer, peaks_of_very_different_size_add) {
    Gaussians model;
    add(model, {0, 0, 0}, {0.3f, 0.3f, 0.3f}, 1e30f);
    add(model, {0, 0, 0}, {0.3f, 0.3f, 0.3f}, 1);
    add(model, {0, 0, 0}, {0.3f, 0.3f, 0.3f}, 0);
    for (const std::string& target : splat_targets())
        expect_exact(model, render_splat(model, kView, 64, 48, {.simd_target = target}), 1);
}

TEST(splat_renderer, more_than_one_batch_adds_up) {
    // More Gaussians than are binned at once (half a million), the last ones alone on the right.
    Gaussians model = random_gaussians(1000, 0.004, 0.02, 46);
    for (Vec3f& mean : model.mean) mean.x = -std::abs(mean.x);
    const Gaussians left = model;
    const std::size_t count = 600000;
    model.mean.resize(count, {0.5f, 0, 0});
    model.scale.resize(count, {0.01f, 0.01f, 0.01f});
    model.rotation.resize(count);
    model.density.resize(count, 0);
    add(model, {0.5f, 0.1f, 0}, {0.05f, 0.05f, 0.05f}, 1, {1, 0, 0, 0});
    Gaussians few = left;
    add(few, {0.5f, 0.1f, 0}, {0.05f, 0.05f, 0.05f}, 1, {1, 0, 0, 0});
    const DepthImage batches = render_splat(model, kView, 200, 150);
    const DepthImage at_once = render_splat(few, kView, 200, 150);
    const float largest = *std::max_element(at_once.depth.begin(), at_once.depth.end());
    // Sums in another order: a few units in the last place of the largest term.
    for (std::size_t n = 0; n < at_once.depth.size(); ++n)
        ASSERT_NEAR(batches.depth[n], at_once.depth[n], 1e-6 * largest);
    EXPECT_NE(at_once.depth, render_splat(left, kView, 200, 150).depth);
}

TEST(splat_renderer, progress_reaches_the_end) {
    const Gaussians model = random_gaussians(100, 0.01, 0.1, 47);
    double of_options = -1, of_call = -1;
    SplatOptions options;
    options.progress = [&](double done) { of_options = done; };
    SplatRenderer renderer(model, options);
    DepthImage image;
    renderer.render(kView, 32, 32, image);
    EXPECT_EQ(of_options, 1);
    of_options = -1;
    renderer.render(kView, 32, 32, image, [&](double done) { of_call = done; });
    EXPECT_EQ(of_options, -1);
    EXPECT_EQ(of_call, 1);
}

TEST(splat_renderer, progress_reaches_the_end_with_bounding_boxes) {
    const Gaussians model = random_gaussians(100, 0.01, 0.1, 47);
    double of_options = -1, of_call = -1;
    SplatOptions options;
    options.aabb_sigma = 1;
    options.progress = [&](double done) { of_options = done; };
    DepthImage image;
    SplatRenderer(model, options).render(kView, 32, 32, image);
    EXPECT_EQ(of_options, 1);
    SplatRenderer(model, options).render(kView, 32, 32, image, [&](double done) {
        of_call = done;
    });
    EXPECT_EQ(of_call, 1);
    of_options = -1;
    SplatRenderer(Gaussians{}, options).render(kView, 32, 32, image);
    EXPECT_EQ(of_options, 1);
}

/// Straight through the mean, tau = density scale sqrt(2 pi) erf(k / sqrt 2), and the peak at the
/// cut is kappa = exp(-k^2 / 2).
TEST(splat_renderer, kappa_cuts_the_kernels) {
    Gaussians model;
    add(model, {0, 0, 0}, {0.5f, 0.5f, 0.5f}, 3);
    Camera camera;
    camera.eye = {0, 0, 10};
    for (const double k : {0.5, 1.5, 2.25, 3.0, 5.0}) {
        SCOPED_TRACE(k);
        SplatOptions options;
        options.kappa = std::exp(-0.5 * k * k);
        const double exact =
            3 * 0.5 * std::sqrt(2 * std::acos(-1.0)) * std::erf(k / std::sqrt(2.0));
        // 21 pixels a deviation: the narrowest kernel is wider than a pixel.
        EXPECT_NEAR(render_splat(model, camera, 301, 301, options).at(150, 150), exact,
                    1e-5 * exact);
        // The same Gaussian around the eye, half of it in front.
        Camera inside = camera;
        inside.eye = {0, 0, 0};
        inside.look_at = {0, 0, -1};
        EXPECT_NEAR(render_splat(model, inside, 1, 1, options).depth[0], 0.5 * exact, 1e-5 * exact);
    }
    // Everywhere, rotated Gaussians and those beside the view too, with and without boxes.
    Gaussians many = random_gaussians(2000, 0.01, 0.2, 49);
    many.box = {{-1, -1, -1}, {1, 1, 1}};
    for (const double aabb_sigma : {0.0, 1.0})
        for (const double kappa : {0.6, 0.001}) {
            SplatOptions options;
            options.aabb_sigma = aabb_sigma;
            options.kappa = kappa;
            SplatOptions of_model;
            of_model.aabb_sigma = aabb_sigma;
            Gaussians recut = many;
            recut.cutoff = static_cast<float>(cutoff_of_kappa(kappa, 0));
            EXPECT_EQ(render_splat(many, kView, 90, 70, options).depth,
                      render_splat(recut, kView, 90, 70, of_model).depth);
        }
}

TEST(splat_renderer, models_that_are_no_models_throw) {
    const Gaussians good = random_gaussians(10, 0.01, 0.1, 48);
    const auto refuses = [&](const auto& spoil) {
        Gaussians model = good;
        spoil(model);
        EXPECT_THROW(SplatRenderer{model}, Error);
        EXPECT_THROW((void)render_splat(model, kView, 8, 8), Error);
    };
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    refuses([](Gaussians& model) { model.scale.pop_back(); });
    refuses([](Gaussians& model) { model.density.clear(); });
    refuses([](Gaussians& model) { model.rotation.pop_back(); });
    refuses([](Gaussians& model) { model.mean[3].y = kNaN; });
    refuses([](Gaussians& model) { model.scale[9].z = 0; });
    refuses([](Gaussians& model) { model.density[0] = -1; });
    refuses([](Gaussians& model) { model.rotation[5] = {0, 0, 0, 0}; });
    refuses([](Gaussians& model) { model.cutoff = 9; });
    for (const double kappa : {-0.1, 1.0, 1e-20, double{kNaN}}) {
        SplatOptions options;
        options.kappa = kappa;
        EXPECT_THROW(SplatRenderer(good, options), Error);
    }
}

TEST(splat_renderer, unusable_sizes_and_targets_throw) {
    const Gaussians model = random_gaussians(10, 0.01, 0.1, 48);
    DepthImage image;
    SplatRenderer renderer(model);
    EXPECT_THROW(renderer.render(kView, 0, 10, image), Error);
    EXPECT_THROW(renderer.render(kView, 70000, 10, image), Error);
    SplatOptions options;
    options.simd_target = "abacus";
    EXPECT_THROW(SplatRenderer(model, options), Error);
}

}  // namespace vog::test
