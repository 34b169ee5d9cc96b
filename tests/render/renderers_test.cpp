// renderers_test.cpp: Every renderer over every scene against the closed form in double precision, and
// properties of T as a plain sum.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>

#include "render/splat/splat.h"
#include "render/trace/trace.h"
#include "support/device_twin.h"
#include "support/gpus.h"
#include "support/scenes.h"
#include "vog/progress.h"

namespace vog::test {

namespace {

struct NamedRenderer {
    std::string name;
    std::function<DepthImage(const Gaussians&, const Camera&, int, int)> render;
};

/// The splat on every SIMD target this machine can run and with a hierarchy, the trace with either
/// any-hit program and with a list of hits that overflows at once, the GPU's splat compiled for the
/// host, and the GPU's renderers where they are emulated.
std::vector<NamedRenderer> all_renderers() {
    std::vector<NamedRenderer> all;
    for (const std::string& target : splat_targets())
        all.push_back(
            {"splat_" + target,
             [target](const Gaussians& model, const Camera& camera, int width, int height) {
                 return render_splat(model, camera, width, height, {.simd_target = target});
             }});
    all.push_back(
        {"splat_of_a_hierarchy", [](Gaussians model, const Camera& camera, int width, int height) {
             const Hierarchy hierarchy = build_hierarchy(model);
             SplatOptions options;
             options.hierarchy = &hierarchy;
             options.cut.pixel_error = 0;
             return render_splat(model, camera, width, height, options);
         }});
    const auto trace = [&](const std::string& name, const TraceOptions& options) {
        all.push_back(
            {name, [options](const Gaussians& model, const Camera& camera, int width, int height) {
                 return render_trace(trace_scene(model), camera, width, height, options);
             }});
    };
    trace("trace_accumulate", {});
    trace("trace_collect", {.anyhit = AnyHit::collect});
    trace("trace_collect_by_16", {.anyhit = AnyHit::collect, .hits_per_slab = 16});
    all.push_back({"tile_splat_twin", render_tile_splat_twin});
    for (auto& [name, render] : gpu_renderers())
        all.push_back({std::move(name), std::move(render)});
    return all;
}

/// A scene that tests print by its name.
struct NamedScene : Scene {
    friend std::ostream& operator<<(std::ostream& out, const NamedScene& scene) {
        return out << scene.name;
    }
};
std::vector<NamedScene> named_scenes() {
    std::vector<NamedScene> all;
    for (Scene& scene : scenes()) all.push_back({std::move(scene)});
    return all;
}

class every_renderer : public testing::TestWithParam<NamedScene> {};

TEST_P(every_renderer, agrees_with_the_closed_form) {
    const Scene& scene = GetParam();
    const std::vector<double> exact = exact_depth(scene);
    const double largest = *std::max_element(exact.begin(), exact.end());
    if (scene.name != "empty" && scene.name != "behind") {
        EXPECT_GT(largest, 0) << "the scene shows nothing";
    }
    for (const NamedRenderer& renderer : all_renderers()) {
        SCOPED_TRACE(renderer.name);
        const DepthImage image =
            renderer.render(scene.model, scene.camera, scene.width, scene.height);
        ASSERT_EQ(image.width, scene.width);
        ASSERT_EQ(image.height, scene.height);
        double worst = 0;
        for (std::size_t n = 0; n < exact.size(); ++n) {
            ASSERT_TRUE(std::isfinite(image.depth[n])) << "pixel " << n;
            ASSERT_GE(image.depth[n], 0) << "pixel " << n;
            worst = std::max(worst, std::abs(image.depth[n] - exact[n]));
        }
        EXPECT_LE(worst, scene.tolerance * largest);
    }
}

INSTANTIATE_TEST_SUITE_P(scenes, every_renderer, testing::ValuesIn(named_scenes()),
                         [](const auto& each) { return each.param.name; });

}  // namespace

TEST(splat, t_of_a_union_is_the_sum_of_the_ts) {
    const Gaussians a = random_gaussians(500, 0.02, 0.2, 21),
                    b = random_gaussians(700, 0.01, 0.3, 22);
    Gaussians both = a;
    append(both, b);
    const Camera camera = paper_view({{-1, -1, -1}, {1, 1, 1}});
    const DepthImage ta = render_splat(a, camera, 64, 64), tb = render_splat(b, camera, 64, 64);
    const DepthImage sum = render_splat(both, camera, 64, 64);
    const float largest = *std::max_element(sum.depth.begin(), sum.depth.end());
    // Float sums in another order: a few units in the last place of the largest term.
    for (std::size_t n = 0; n < sum.depth.size(); ++n)
        ASSERT_NEAR(sum.depth[n], ta.depth[n] + tb.depth[n], 2e-6 * largest);
}

TEST(splat, same_bytes_for_any_number_of_threads) {
    const Gaussians model = random_gaussians(20000, 0.005, 0.1, 23);
    const Camera camera = paper_view({{-1, -1, -1}, {1, 1, 1}});
    std::vector<DepthImage> images;
    for (const int threads : {1, 2, 8}) {
        const ThreadLimit limit(threads);
        images.push_back(render_splat(model, camera, 200, 150));
    }
    EXPECT_EQ(images[0].depth, images[1].depth);
    EXPECT_EQ(images[0].depth, images[2].depth);
}

TEST(splat, closed_form_through_the_centre) {
    // Straight through the mean: tau = a s sqrt(2 pi) erf(k / sqrt 2).
    Gaussians model;
    add(model, {0, 0, 0}, {0.5f, 0.5f, 0.5f}, 3);
    Camera camera;
    camera.eye = {0, 0, 10};
    const DepthImage image = render_splat(model, camera, 65, 65);  // 4.6 pixels a deviation
    const double expected =
        3 * 0.5 * std::sqrt(2 * std::acos(-1.0)) * std::erf(2.25 / std::sqrt(2.0));
    EXPECT_NEAR(image.at(32, 32), expected, 1e-5 * expected);
}

TEST(splat, half_of_a_gaussian_lies_before_an_eye_at_its_mean) {
    Gaussians model;
    add(model, {0, 0, 0}, {0.5f, 0.5f, 0.5f}, 3);
    Camera camera;
    camera.eye = {0, 0, 0};
    camera.look_at = {0, 0, -1};
    const DepthImage image = render_splat(model, camera, 1, 1);
    const double whole = 3 * 0.5 * std::sqrt(2 * std::acos(-1.0)) * std::erf(2.25 / std::sqrt(2.0));
    EXPECT_NEAR(image.depth[0], 0.5 * whole, 1e-5 * whole);
}

}  // namespace vog::test
