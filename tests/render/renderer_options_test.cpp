// renderer_options_test.cpp: Table of renderers and their options.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/refusal.h"
#include "vog/renderer.h"

namespace vog::test {

namespace {

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

}  // namespace vog::test
