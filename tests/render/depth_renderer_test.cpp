// depth_renderer_test.cpp: Table of renderers and options, and DepthRenderer against the renderers that
// it stands for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "render/trace/trace.h"
#include "support/random_volume.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/renderer.h"

namespace vog::test {

namespace {

const Camera kView = paper_view({{-1, -1, -1}, {1, 1, 1}});

DepthImage draw(DepthRenderer renderer, const Camera& camera = kView) {
    DepthImage image;
    renderer.render(camera, 40, 30, image);
    return image;
}

std::shared_ptr<const Gaussians> some_gaussians() {
    return std::make_shared<const Gaussians>(random_gaussians(500, 0.01, 0.2, 71));
}

std::string flags_refused(Renderer renderer, RenderInput input,
                          const std::vector<RenderOption>& given) {
    return refusal([&] { require_options(renderer, input, given, OptionSpelling::flags); });
}

}  // namespace

TEST(renderers, are_found_by_name) {
    for (const RendererInfo& one : renderers()) {
        EXPECT_EQ(renderer_named(one.name), one.renderer);
        EXPECT_EQ(info_of(one.renderer).name, one.name);
        EXPECT_FALSE(one.draws.empty()) << one.name;
    }
    EXPECT_EQ(refusal([] { (void)renderer_named("magic"); }),
              "renderer 'magic', expected 'splat', 'trace', 'cuda', 'optix' or 'reference'");
}

TEST(renderers, default_and_fit_to_the_input) {
    EXPECT_EQ(renderer_for("", RenderInput::gaussians), Renderer::splat);
    EXPECT_EQ(renderer_for("", RenderInput::volumes), Renderer::reference);
    EXPECT_EQ(renderer_for("", RenderInput::levels), Renderer::reference);
    EXPECT_EQ(renderer_for("optix", RenderInput::volumes), Renderer::optix);
    EXPECT_EQ(refusal([] { (void)renderer_for("reference", RenderInput::gaussians); }),
              "renderer 'reference', expected 'splat', 'trace', 'cuda' or 'optix' for Gaussians");
    EXPECT_EQ(refusal([] { (void)renderer_for("splat", RenderInput::volumes); }),
              "renderer 'splat', expected 'optix' or 'reference' for volumes");
    EXPECT_EQ(renderer_for("optix", RenderInput::levels), Renderer::optix);
    EXPECT_EQ(refusal([] { (void)renderer_for("trace", RenderInput::levels); }),
              "renderer 'trace', expected 'optix' or 'reference' for levels");
}

TEST(renderers, options_of_others_are_refused_in_one_line) {
    const auto gaussians = RenderInput::gaussians, volumes = RenderInput::volumes;
    EXPECT_EQ(flags_refused(Renderer::reference, volumes, {RenderOption::kappa}),
              "--kappa is not for --renderer reference, expected splat or trace or optix or cuda");
    EXPECT_EQ(flags_refused(Renderer::splat, gaussians, {RenderOption::hits_per_slab}),
              "--slab-hits is not for --renderer splat, expected trace or optix");
    EXPECT_EQ(flags_refused(Renderer::optix, volumes, {RenderOption::anyhit}),
              "--anyhit is for Gaussians, not for voxels");
    EXPECT_EQ(flags_refused(Renderer::splat, gaussians,
                            {RenderOption::pixel_error, RenderOption::aabb_sigma}),
              "--pixel-error does not go with --aabb-sigma");
    EXPECT_EQ(flags_refused(Renderer::reference, volumes,
                            {RenderOption::interpolation, RenderOption::step}),
              "no error");
    EXPECT_EQ(refusal([] {
                  require_options(Renderer::splat, RenderInput::gaussians,
                                  std::vector{RenderOption::hits_per_slab},
                                  OptionSpelling::arguments);
              }),
              "hits_per_slab is not for renderer 'splat', expected 'trace' or 'optix'");
}

TEST(renderers, changed_options_are_those_that_differ_from_the_defaults) {
    EXPECT_TRUE(changed_options({}).empty());
    RenderOptions all;
    all.aabb_sigma = all.kappa = all.trace.stop_transmittance = all.voxels.step_voxels = 0.5;
    all.pixel_error = 1;
    all.trace.anyhit = AnyHit::collect;
    all.trace.hits_per_slab = 7;
    all.voxels.interpolation = Interpolation::linear;
    all.clip.box = Box{{0, 0, 0}, {1, 1, 1}};
    EXPECT_EQ(changed_options(all).size(), 9u);
}

TEST(depth_renderer, draws_what_splat_and_trace_draw) {
    const auto model = some_gaussians();
    RenderOptions options;
    options.kappa = 0.1;
    SplatOptions splat;
    splat.kappa = 0.1;
    EXPECT_EQ(draw(DepthRenderer(Renderer::splat, model, options)).depth,
              render_splat(*model, kView, 40, 30, splat).depth);
    options.trace.anyhit = AnyHit::collect;
    DepthRenderer trace(Renderer::trace, model, options);
    EXPECT_FALSE(trace.traced());
    DepthImage image;
    double done = 0;
    trace.render(kView, 40, 30, image, [&](double fraction) { done = fraction; });
    EXPECT_EQ(done, 1);
    TraceReport report;
    EXPECT_EQ(image.depth, render_trace(trace_scene(*model, {.kappa = 0.1}), kView, 40, 30,
                                        options.trace, &report)
                               .depth);
    ASSERT_TRUE(trace.traced());
    EXPECT_EQ(trace.traced()->hits, report.hits);
    EXPECT_FALSE(trace.cut());
}

TEST(depth_renderer, draws_cuts_through_a_hierarchy) {
    Gaussians sorted = random_gaussians(3000, 0.002, 0.02, 72);
    const auto hierarchy = std::make_shared<const Hierarchy>(build_hierarchy(sorted));
    const auto model = std::make_shared<const Gaussians>(std::move(sorted));
    DepthRenderer renderer(Renderer::splat, model, {.pixel_error = 0.0}, hierarchy);
    DepthImage image;
    renderer.render(kView, 40, 30, image);
    EXPECT_EQ(image.depth, render_splat(*model, kView, 40, 30).depth);
    ASSERT_TRUE(renderer.cut());
    EXPECT_EQ(renderer.cut()->drawn(), model->size());
    renderer.set_pixel_error(5);
    renderer.render(kView, 40, 30, image);
    EXPECT_LT(renderer.cut()->drawn(), model->size() / 2);
    // Boxes are of the model's own Gaussians.
    DepthRenderer boxed(Renderer::splat, model, {.aabb_sigma = 1}, hierarchy);
    boxed.render(kView, 40, 30, image);
    EXPECT_FALSE(boxed.cut());
}

TEST(depth_renderer, volumes_add_up_or_hide_each_other) {
    VolumeSet set{{{random_volume(73), random_volume(74)}, {}}, Overlap::add};
    const Camera camera = paper_view({{-9, -9, -9}, {17, 17, 17}});
    const std::vector<VoxelGrid> grids{voxel_grid(set.volumes[0]), voxel_grid(set.volumes[1])};
    const DepthImage sum = render_reference(grids, camera, 40, 30);
    EXPECT_EQ(draw(DepthRenderer(Renderer::reference, set), camera).depth, sum.depth);
    set.overlap = Overlap::hide;
    const DepthImage mesh = render_reference(level_grids(set), camera, 40, 30);
    EXPECT_EQ(draw(DepthRenderer(Renderer::reference, set), camera).depth, mesh.depth);
    EXPECT_NE(sum.depth, mesh.depth);
}

TEST(depth_renderer, refuses_other_data_and_options) {
    const auto model = some_gaussians();
    const VolumeSet set{{{random_volume(75)}, {}}, Overlap::hide};
    EXPECT_THROW(DepthRenderer(Renderer::reference, model), Error);
    EXPECT_THROW(DepthRenderer(Renderer::splat, set), Error);
    EXPECT_THROW(DepthRenderer(Renderer::splat, model, {.voxels = {Interpolation::linear, 0}}),
                 Error);
    EXPECT_THROW(DepthRenderer(Renderer::reference, set, {.kappa = 0.1}), Error);
}

TEST(depth_renderer, clips_cut_the_chords_of_gaussians) {
    const auto model = some_gaussians();
    const std::vector<float> whole = draw(DepthRenderer(Renderer::splat, model, {})).depth;
    const double largest = double{*std::ranges::max_element(whole)};
    ASSERT_GT(largest, 0);
    // Two halves make the whole, at a plane askew through the middle.
    const Vec3d normal{0.3, -0.7, 0.2}, middle = view_box(*model).center();
    for (const Renderer renderer : {Renderer::splat, Renderer::trace}) {
        std::vector<double> sum(whole.size(), 0);
        double least = HUGE_VAL;
        for (const double sign : {1.0, -1.0}) {
            RenderOptions options;
            options.clip.planes.push_back({sign * normal, sign * dot(normal, middle)});
            const DepthImage half = draw(DepthRenderer(renderer, model, options));
            double all = 0;
            for (std::size_t n = 0; n < sum.size(); ++n)
                sum[n] += double{half.depth[n]}, all += double{half.depth[n]};
            least = std::min(least, all);
        }
        EXPECT_GT(least, 0);
        for (std::size_t n = 0; n < sum.size(); ++n)
            EXPECT_NEAR(sum[n], double{whole[n]}, 1e-4 * largest) << n;
        RenderOptions all;
        all.clip.box = view_box(*model);
        all.clip.box->include(all.clip.box->upper + Vec3d{99, 99, 99});
        all.clip.box->include(all.clip.box->lower - Vec3d{99, 99, 99});
        const std::vector<float> same = draw(DepthRenderer(renderer, model, all)).depth;
        for (std::size_t n = 0; n < same.size(); ++n)
            EXPECT_NEAR(double{same[n]}, double{whole[n]}, 1e-4 * largest) << n;
        all.aabb_sigma = 1;
        EXPECT_THROW(DepthRenderer(renderer, model, all), Error);
    }
}

}  // namespace vog::test
