// renderer_test.cpp: Table of renderers.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "render/picture/request/request_effects.h"
#include "support/refusal.h"
#include "vog/picture_record.h"
#include "vog/renderer.h"

namespace vog::test {

namespace {

std::string refused(Renderer renderer, RenderInput input, const std::string& request) {
    return refusal([&] { require_renderer_effects(request_of_json(request), renderer, input); });
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

TEST(renderers, members_of_requests_of_others_are_refused_in_one_line) {
    const auto gaussians = RenderInput::gaussians, volumes = RenderInput::volumes;
    EXPECT_EQ(
        refused(Renderer::reference, volumes, R"({"kappa": 0.1})"),
        "kappa is not for renderer 'reference', expected 'splat', 'trace', 'optix' or 'cuda'");
    EXPECT_EQ(refused(Renderer::splat, gaussians, R"({"anyhit": "collect", "hits_per_slab": 4})"),
              "anyhit is not for renderer 'splat', expected 'trace' or 'optix'");
    EXPECT_EQ(refused(Renderer::trace, gaussians, R"({"hits_per_slab": 4})"),
              "hits_per_slab needs anyhit 'collect'");
    EXPECT_EQ(refused(Renderer::optix, volumes, R"({"anyhit": "collect"})"),
              "anyhit is for Gaussians, not for voxels");
    EXPECT_EQ(refused(Renderer::splat, gaussians, R"({"pixel_error": 1, "aabb_sigma": 2})"),
              "pixel_error has no effect beside `aabb_sigma`");
    EXPECT_EQ(refused(Renderer::reference, volumes, R"({"step": 0.5})"),
              "step needs interpolation 'linear'");
    EXPECT_EQ(refused(Renderer::reference, volumes, R"({"step": 0.5, "interpolation": "linear"})"),
              "no error");
}

}  // namespace vog::test
