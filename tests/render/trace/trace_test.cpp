// trace_test.cpp: The ray tracer beyond the scenes of every renderer: any-hit programs, slabs, the
// paper's boxes and cutoff, early termination.
#include "render/trace/trace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/splat/splat.h"
#include "support/scenes.h"
#include "vog/error.h"

namespace vog::test {

namespace {

const Camera kFront = paper_view({{-1, -1, -1}, {1, 1, 1}});

Scene scene_named(const std::string& name) {
    for (const Scene& scene : scenes())
        if (scene.name == name) return scene;
    throw Error("no scene " + name);
}

DepthImage trace(const Scene& scene, const TraceOptions& options = {},
                 TraceReport* report = nullptr) {
    return render_trace(trace_scene(scene.model), scene.camera, scene.width, scene.height, options,
                        report);
}

/// A scene in nine times the pixels of its middle: no Gaussian of "on_one_ray" is below a pixel.
Scene larger(Scene scene) {
    scene.camera.fov_degrees /= 9;
    return scene;
}

TraceOptions collecting(int hits_per_slab) {
    TraceOptions options;
    options.anyhit = AnyHit::collect;
    options.hits_per_slab = hits_per_slab;
    return options;
}

/// Pixels that differ by more than `tolerance` of the largest T.
std::size_t pixels_apart(const DepthImage& a, const DepthImage& b, double tolerance) {
    const float largest = *std::max_element(a.depth.begin(), a.depth.end());
    std::size_t apart = 0;
    for (std::size_t n = 0; n < a.depth.size(); ++n)
        apart += std::abs(double{a.depth[n]} - double{b.depth[n]}) > tolerance * largest;
    return apart;
}

}  // namespace

TEST(trace, either_any_hit_and_any_slab_give_the_same_bytes) {
    for (const char* name : {"inside_many", "around_the_eye", "on_one_ray", "along_axes"}) {
        SCOPED_TRACE(name);
        const Scene scene = larger(scene_named(name));
        TraceReport accumulated;
        const DepthImage expected = trace(scene, {}, &accumulated);
        EXPECT_GT(accumulated.hits, 0u);
        for (const int hits : {7, 64, 256}) {
            TraceReport collected;
            EXPECT_EQ(trace(scene, collecting(hits), &collected).depth, expected.depth) << hits;
            EXPECT_EQ(collected.hits, accumulated.hits) << hits;
        }
    }
}

TEST(trace, an_overflowing_list_is_counted_in_slabs) {
    // Every ray through the middle meets all 10,000 but those whose support is too thin there.
    const Scene scene = larger(scene_named("on_one_ray"));
    TraceReport report;
    (void)trace(scene, collecting(100), &report);
    EXPECT_GE(report.most_slabs, 100);
    EXPECT_LE(report.most_slabs, 101);
    EXPECT_GE(report.slabs * 100, report.hits);
    (void)trace(scene_named("one_on_axis"), collecting(1), &report);
    EXPECT_EQ(report.most_slabs, 1);
}

TEST(trace, same_bytes_for_any_number_of_threads) {
    const Gaussians model = random_gaussians(20000, 0.005, 0.1, 23);
    for (const AnyHit anyhit : {AnyHit::accumulate, AnyHit::collect}) {
        std::vector<DepthImage> images;
        for (const int threads : {1, 2, 8}) {
            const ThreadLimit limit(threads);
            images.push_back(render_trace(trace_scene(model), kFront, 100, 75, {.anyhit = anyhit}));
        }
        EXPECT_EQ(images[0].depth, images[1].depth);
        EXPECT_EQ(images[0].depth, images[2].depth);
    }
}

TEST(trace, t_does_not_depend_on_the_order_of_the_gaussians) {
    const Gaussians model = random_gaussians(2000, 0.02, 0.2, 24);
    Gaussians reversed = model;
    std::reverse(reversed.mean.begin(), reversed.mean.end());
    std::reverse(reversed.scale.begin(), reversed.scale.end());
    std::reverse(reversed.rotation.begin(), reversed.rotation.end());
    std::reverse(reversed.density.begin(), reversed.density.end());
    EXPECT_EQ(render_trace(trace_scene(model), kFront, 64, 64).depth,
              render_trace(trace_scene(reversed), kFront, 64, 64).depth);
}

TEST(trace, agrees_with_the_splat) {
    // The documentation promises 1e-4 of the largest T; both lie within 1e-5 of the closed form.
    for (const char* name : {"many", "ten_thousand", "inside_many", "far_away"}) {
        const Scene scene = scene_named(name);
        const DepthImage splat = render_splat(scene.model, scene.camera, scene.width, scene.height);
        EXPECT_EQ(pixels_apart(splat, trace(scene), 2e-5), 0u) << name;
    }
}

TEST(trace, the_papers_boxes_cut_as_those_of_the_splat) {
    for (const char* name : {"one_off_axis", "rotated", "inside_many", "eye_inside", "many"})
        for (const double sigma : {0.5, 1.0, 2.0, 3.0}) {
            SCOPED_TRACE(testing::Message() << name << ", sigma " << sigma);
            const Scene scene = scene_named(name);
            SplatOptions splat;
            splat.aabb_sigma = sigma;
            const DepthImage emulated =
                render_splat(scene.model, scene.camera, scene.width, scene.height, splat);
            const TraceScene boxed = trace_scene(scene.model, {.aabb_sigma = sigma});
            const DepthImage accumulated =
                render_trace(boxed, scene.camera, scene.width, scene.height);
            // A ray within a float's rounding of a face may fall either way, and differ by a whole
            // Gaussian: one pixel in a thousand.
            EXPECT_LE(pixels_apart(emulated, accumulated, 2e-5), emulated.depth.size() / 1000);
            EXPECT_EQ(
                render_trace(boxed, scene.camera, scene.width, scene.height, collecting(5)).depth,
                accumulated.depth);
        }
}

TEST(trace, small_boxes_find_less) {
    const Scene scene = scene_named("rotated");
    const DepthImage whole = trace(scene);
    const DepthImage cut =
        render_trace(trace_scene(scene.model, {.aabb_sigma = 0.5}), scene.camera, 64, 64);
    EXPECT_GT(pixels_apart(whole, cut, 1e-3), 50u);
}

TEST(trace, kappa_is_the_cutoff) {
    Scene scene = scene_named("many");
    const DepthImage at_kappa = render_trace(trace_scene(scene.model, {.kappa = 0.01}),
                                             scene.camera, scene.width, scene.height);
    scene.model.cutoff = static_cast<float>(std::sqrt(-2 * std::log(0.01)));
    EXPECT_EQ(pixels_apart(trace(scene), at_kappa, 1e-6), 0u);
}

TEST(trace, an_opaque_ray_ends_early_within_the_stated_transmittance) {
    Scene scene = larger(scene_named("on_one_ray"));
    for (float& density : scene.model.density) density *= 100;
    TraceReport whole, stopped;
    const DepthImage full = trace(scene, collecting(64), &whole);
    TraceOptions options = collecting(64);
    options.stop_transmittance = 0.001;
    const DepthImage early = trace(scene, options, &stopped);
    EXPECT_LT(stopped.slabs, whole.slabs / 2);
    for (std::size_t n = 0; n < full.depth.size(); ++n) {
        EXPECT_LE(early.depth[n], full.depth[n]);
        EXPECT_LE(std::exp(-early.depth[n]) - std::exp(-full.depth[n]), 0.001);
    }
    // At a tenth of the extinction the ray through the middle goes ten times as deep.
    options.extinction = 0.1;
    TraceReport deeper;
    (void)trace(scene, options, &deeper);
    EXPECT_GE(deeper.most_slabs, 7 * stopped.most_slabs);
    EXPECT_LE(deeper.most_slabs, 11 * stopped.most_slabs);
}

TEST(trace, gaussians_of_no_density_leave_the_background) {
    Gaussians model;
    add(model, {0, 0, 0}, {0.5f, 0.5f, 0.5f}, 0);
    const DepthImage image = render_trace(trace_scene(model), kFront, 9, 9);
    EXPECT_EQ(*std::max_element(image.depth.begin(), image.depth.end()), 0);
}

TEST(trace, thinner_than_a_float_can_place_keeps_its_mass) {
    // A disc of 1e-15 units of thickness: tau = density * thickness * sqrt(2 pi) erf(k / sqrt 2).
    Gaussians model;
    add(model, {0, 0, 0}, {1, 1, 1e-15f}, 1e15f);
    Camera camera;
    camera.eye = {0, 0, 5};
    const DepthImage image = render_trace(trace_scene(model), camera, 33, 33);
    const double expected = std::sqrt(2 * std::acos(-1.0)) * std::erf(2.25 / std::sqrt(2.0));
    EXPECT_NEAR(image.at(16, 16), expected, 1e-5 * expected);
}

TEST(trace, densities_of_any_size_give_the_same_picture) {
    const Scene scene = scene_named("inside_many");
    const DepthImage expected = trace(scene, {});
    const DepthImage collected = trace(scene, collecting(7));
    for (const int exponent : {-110, -60, 90, 118}) {
        Scene other = scene;
        for (float& density : other.model.density) density = std::ldexp(density, exponent);
        const DepthImage image = trace(other, {}), slabs = trace(other, collecting(7));
        for (std::size_t n = 0; n < image.depth.size(); ++n) {
            ASSERT_EQ(image.depth[n], std::ldexp(expected.depth[n], exponent)) << exponent;
            ASSERT_EQ(slabs.depth[n], std::ldexp(collected.depth[n], exponent)) << exponent;
        }
    }
}

TEST(trace, the_ends_of_the_range_of_floats_agree_with_the_splat) {
    for (const auto& [scale, density] : {std::pair{1.0f, 1e-40f}, std::pair{1e38f, 1.0f},
                                         std::pair{1e38f, 1e-40f}, std::pair{1e-37f, 3e38f}}) {
        Gaussians model;
        add(model, {0, 0, 0}, {scale, scale, scale}, density);
        const Camera camera = orbit_view(view_box(model), {});
        const DepthImage splat = render_splat(model, camera, 33, 33);
        const DepthImage image = render_trace(trace_scene(model), camera, 33, 33);
        const float largest = *std::max_element(splat.depth.begin(), splat.depth.end());
        ASSERT_GT(largest, 0) << scale << ' ' << density;
        // Denormal floats have four digits at 1e-40.
        for (std::size_t n = 0; n < splat.depth.size(); ++n)
            ASSERT_NEAR(image.depth[n] / double{largest}, splat.depth[n] / double{largest}, 1e-4)
                << scale << ' ' << density;
    }
}

TEST(trace, options_out_of_range_throw) {
    const Gaussians model = random_gaussians(3, 0.1, 0.2, 25);
    for (const double bad : {-1.0, std::nan(""), HUGE_VAL}) {
        EXPECT_THROW((void)trace_scene(model, {.aabb_sigma = bad}), Error) << bad;
        EXPECT_THROW((void)trace_scene(model, {.kappa = bad}), Error) << bad;
    }
    EXPECT_THROW((void)trace_scene(model, {.kappa = 1}), Error);
    const TraceScene scene = trace_scene(model);
    const auto refused = [&](const TraceOptions& options) {
        EXPECT_THROW((void)render_trace(scene, kFront, 8, 8, options), Error);
    };
    refused(collecting(0));
    refused(collecting(257));
    refused({.stop_transmittance = 0.001});  // hits in no order
    TraceOptions options = collecting(64);
    options.stop_transmittance = 1;
    refused(options);
    options.stop_transmittance = 0.5;
    options.extinction = 0;
    refused(options);
    EXPECT_THROW((void)render_trace(scene, kFront, 0, 8), Error);
}

TEST(trace, an_invalid_model_throws) {
    Gaussians model = random_gaussians(3, 0.1, 0.2, 26);
    model.density[1] = std::nanf("");
    EXPECT_THROW((void)trace_scene(model), Error);
}

}  // namespace vog::test
