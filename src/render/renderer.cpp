// renderer.cpp: Table of the renderers.
#include <fmt/format.h>

#include <algorithm>

#include "vog/error.h"
#include "vog/renderer.h"

namespace vog {

namespace {

#ifdef VOG_CUDA
constexpr bool kCuda = true;
#else
constexpr bool kCuda = false;
#endif
#ifdef VOG_OPTIX
constexpr bool kOptix = true;
#else
constexpr bool kOptix = false;
#endif

/// "'splat', 'trace' or 'optix'"
std::string quoted_list(const std::vector<Renderer>& all) {
    std::string text;
    for (std::size_t n = 0; n < all.size(); ++n) {
        if (n > 0) text += n + 1 < all.size() ? ", " : " or ";
        text += fmt::format("'{}'", info_of(all[n]).name);
    }
    return text;
}

}  // namespace

std::span<const RendererInfo> renderers() {
    using enum RenderInput;
    static const std::vector<RendererInfo> all = {
        {Renderer::splat, "splat", "models and particles, exact, object order", true, {gaussians}},
        {Renderer::trace, "trace", "the same, ray by ray", true, {gaussians}},
        {Renderer::cuda, "cuda", "splat on an NVIDIA GPU", kCuda, {gaussians}},
        {Renderer::optix,
         "optix",
         "trace on an NVIDIA GPU, and volumes",
         kOptix,
         {gaussians, volumes, levels}},
        {Renderer::reference,
         "reference",
         "volumes, exact through the voxels",
         true,
         {volumes, levels, cells}},
    };
    return all;
}

const RendererInfo& info_of(Renderer renderer) {
    return *std::ranges::find(renderers(), renderer, &RendererInfo::renderer);
}

bool draws(Renderer renderer, RenderInput input) {
    return std::ranges::find(info_of(renderer).draws, input) != info_of(renderer).draws.end();
}

Renderer renderer_named(std::string_view name) {
    std::vector<Renderer> all;
    for (const RendererInfo& one : renderers()) {
        if (name == one.name) return one.renderer;
        all.push_back(one.renderer);
    }
    throw Error(fmt::format("renderer '{}', expected {}", name, quoted_list(all)));
}

Renderer renderer_for(std::string_view name, RenderInput input) {
    if (name.empty())
        return input == RenderInput::gaussians ? Renderer::splat : Renderer::reference;
    std::vector<Renderer> fitting;
    for (const RendererInfo& one : renderers()) {
        if (!draws(one.renderer, input)) continue;
        if (name == one.name) return one.renderer;
        fitting.push_back(one.renderer);
    }
    const char* data = input == RenderInput::gaussians ? "Gaussians"
                       : input == RenderInput::volumes ? "volumes"
                       : input == RenderInput::cells   ? "cells"
                                                       : "levels";
    throw Error(fmt::format("renderer '{}', expected {} for {}", name, quoted_list(fitting), data));
}

}  // namespace vog
