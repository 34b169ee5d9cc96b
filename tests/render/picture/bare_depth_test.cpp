// bare_depth_test.cpp: T of requests with options and reports, against the renderers themselves.
#include <gtest/gtest.h>

#include <string>

#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "render/trace/trace.h"
#include "support/random_volume.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/lod.h"
#include "vog/picture.h"

namespace vog::test {

namespace {

const Camera kView = paper_view({{-1, -1, -1}, {1, 1, 1}});
constexpr int kBareWidth = 40, kBareHeight = 30;

PictureRequest request_by(Renderer renderer, const Camera& camera = kView) {
    return {.camera = camera, .width = kBareWidth, .height = kBareHeight, .renderer = renderer};
}

}  // namespace

TEST(bare_depth, is_that_of_splat_and_trace_with_their_options) {
    const Gaussians model = random_gaussians(500, 0.01, 0.2, 71);
    PictureRenderer renderer(scene_of(model));
    PictureRequest request = request_by(Renderer::splat);
    request.options.kappa = 0.1;
    SplatOptions splat;
    splat.kappa = 0.1;
    EXPECT_EQ(bare_depth(renderer, request).depth,
              render_splat(model, kView, kBareWidth, kBareHeight, splat).depth);
    EXPECT_FALSE(renderer.report().traced);
    request.renderer = Renderer::trace;
    request.options.trace.anyhit = AnyHit::collect;
    double done = 0;
    const DepthImage image =
        bare_depth(renderer, request, [&](double fraction) { done = fraction; });
    EXPECT_EQ(done, 1);
    TraceReport report;
    EXPECT_EQ(image.depth, render_trace(trace_scene(model, {.kappa = 0.1}), kView, kBareWidth,
                                        kBareHeight, request.options.trace, &report)
                               .depth);
    ASSERT_TRUE(renderer.report().traced);
    EXPECT_EQ(renderer.report().traced->hits, report.hits);
    EXPECT_FALSE(renderer.report().cut);
}

TEST(bare_depth, is_that_of_cuts_through_a_hierarchy) {
    Gaussians sorted = random_gaussians(3000, 0.002, 0.02, 72);
    const auto hierarchy = std::make_shared<const Hierarchy>(build_hierarchy(sorted));
    const auto model = std::make_shared<const Gaussians>(std::move(sorted));
    PictureRenderer renderer(scene_of(model, hierarchy));
    PictureRequest request = request_by(Renderer::splat);
    request.options.pixel_error = 0;
    EXPECT_EQ(bare_depth(renderer, request).depth,
              render_splat(*model, kView, kBareWidth, kBareHeight).depth);
    ASSERT_TRUE(renderer.report().cut);
    EXPECT_EQ(renderer.report().cut->drawn(), model->size());
    request.options.pixel_error = 5;
    (void)bare_depth(renderer, request);
    EXPECT_LT(renderer.report().cut->drawn(), model->size() / 2);
    // Boxes are of the model's own Gaussians.
    request.options = {.aabb_sigma = 1};
    (void)bare_depth(renderer, request);
    EXPECT_FALSE(renderer.report().cut);
}

TEST(bare_depth, is_that_of_volumes_which_add_up_or_hide_each_other) {
    VolumeSet set{{{random_volume(73), random_volume(74)}, {}}, Overlap::add};
    const Camera camera = paper_view({{-9, -9, -9}, {17, 17, 17}});
    const auto drawn = [&] {
        PictureRenderer renderer(scene_of(std::make_shared<const VolumeSet>(set)));
        return bare_depth(renderer, request_by(Renderer::reference, camera));
    };
    const std::vector<VoxelGrid> grids{voxel_grid(set.volumes[0]), voxel_grid(set.volumes[1])};
    const DepthImage sum = render_reference(grids, camera, kBareWidth, kBareHeight);
    EXPECT_EQ(drawn().depth, sum.depth);
    set.overlap = Overlap::hide;
    const DepthImage mesh = render_reference(level_grids(set), camera, kBareWidth, kBareHeight);
    EXPECT_EQ(drawn().depth, mesh.depth);
    EXPECT_NE(sum.depth, mesh.depth);
}

TEST(bare_depth, is_refused_for_other_data_and_options) {
    PictureRenderer model(scene_of(random_gaussians(50, 0.01, 0.2, 71))),
        voxels(scene_of(random_volume(75)));
    const auto refused = [](PictureRenderer& renderer, Renderer by, const RenderOptions& options) {
        PictureRequest request = request_by(by);
        request.options = options;
        return refusal([&] { (void)bare_depth(renderer, request); }) != "no error";
    };
    EXPECT_FALSE(refused(model, Renderer::splat, {}));
    EXPECT_TRUE(refused(model, Renderer::reference, {}));
    EXPECT_TRUE(refused(voxels, Renderer::splat, {}));
    EXPECT_TRUE(refused(model, Renderer::splat, {.voxels = {Interpolation::linear, 0}}));
    EXPECT_TRUE(refused(voxels, Renderer::reference, {.kappa = 0.1}));
}

}  // namespace vog::test
