// renderer_options.cpp: Tables of the renderers and of the options that go with each.
#include <fmt/format.h>
#include <fmt/ranges.h>

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

struct OptionRow {
    RenderOption option;
    const char *flag, *argument;
    std::vector<Renderer> renderers;
};
const std::vector<OptionRow>& option_table() {
    using enum Renderer;
    static const std::vector<OptionRow> table = {
        {RenderOption::anyhit, "--anyhit", "anyhit", {trace, optix}},
        {RenderOption::hits_per_slab, "--slab-hits", "hits_per_slab", {trace, optix}},
        {RenderOption::stop_transmittance,
         "--stop-transmittance",
         "stop_transmittance",
         {trace, optix}},
        {RenderOption::aabb_sigma, "--aabb-sigma", "aabb_sigma", {splat, trace, optix}},
        {RenderOption::pixel_error, "--pixel-error", "pixel_error", {splat, optix, cuda}},
        {RenderOption::kappa, "--kappa", "kappa", {splat, trace, optix, cuda}},
        {RenderOption::interpolation, "--interpolation", "interpolation", {reference}},
        {RenderOption::step, "--step", "step", {reference}},
        {RenderOption::samples, "--samples", "samples", {reference, optix}},
        {RenderOption::clip, "--clip", "clip", {reference, splat, trace, optix, cuda}},
    };
    return table;
}
const OptionRow& row_of(RenderOption option) {
    return *std::ranges::find(option_table(), option, &OptionRow::option);
}

bool contains(std::span<const RenderOption> options, RenderOption option) {
    return std::ranges::find(options, option) != options.end();
}

/// "'splat', 'trace' or 'optix'"
std::string quoted_list(const std::vector<Renderer>& all) {
    std::string text;
    for (std::size_t n = 0; n < all.size(); ++n) {
        if (n > 0) text += n + 1 < all.size() ? ", " : " or ";
        text += fmt::format("'{}'", info_of(all[n]).name);
    }
    return text;
}

std::string refusal(const OptionRow& row, Renderer renderer, OptionSpelling spelling) {
    if (spelling == OptionSpelling::arguments)
        return fmt::format("{} is not for renderer '{}', expected {}", row.argument,
                           info_of(renderer).name, quoted_list(row.renderers));
    std::vector<std::string> names;
    for (const Renderer one : row.renderers) names.emplace_back(info_of(one).name);
    return fmt::format("{} is not for --renderer {}, expected {}", row.flag, info_of(renderer).name,
                       fmt::join(names, " or "));
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
         {volumes, levels}},
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
                                                       : "levels";
    throw Error(fmt::format("renderer '{}', expected {} for {}", name, quoted_list(fitting), data));
}

std::vector<RenderOption> changed_options(const RenderOptions& options) {
    const RenderOptions unset;
    std::vector<RenderOption> changed;
    const auto add = [&](bool differs, RenderOption option) {
        if (differs) changed.push_back(option);
    };
    add(options.trace.anyhit != unset.trace.anyhit, RenderOption::anyhit);
    add(options.trace.hits_per_slab != unset.trace.hits_per_slab, RenderOption::hits_per_slab);
    add(options.trace.stop_transmittance != 0, RenderOption::stop_transmittance);
    add(options.aabb_sigma != 0, RenderOption::aabb_sigma);
    add(options.pixel_error.has_value(), RenderOption::pixel_error);
    add(options.kappa != 0, RenderOption::kappa);
    add(options.voxels.interpolation != unset.voxels.interpolation, RenderOption::interpolation);
    add(options.voxels.step_voxels != unset.voxels.step_voxels, RenderOption::step);
    add(options.samples != unset.samples, RenderOption::samples);
    add(!options.clip.empty(), RenderOption::clip);
    return changed;
}

std::string spelled(RenderOption option, OptionSpelling spelling) {
    const OptionRow& row = row_of(option);
    return spelling == OptionSpelling::flags ? row.flag : row.argument;
}

void require_options(Renderer renderer, RenderInput input, std::span<const RenderOption> given,
                     OptionSpelling spelling) {
    for (const OptionRow& row : option_table())
        if (contains(given, row.option) &&
            std::ranges::find(row.renderers, renderer) == row.renderers.end())
            throw Error(refusal(row, renderer, spelling));
    const auto require = [&](RenderOption option, RenderOption other, const char* value) {
        if (!contains(given, option) || contains(given, other)) return;
        const char* quote = spelling == OptionSpelling::arguments ? "'" : "";
        throw Error(fmt::format("{} needs {} {}{}{}", spelled(option, spelling),
                                spelled(other, spelling), quote, value, quote));
    };
    require(RenderOption::step, RenderOption::interpolation, "linear");
    require(RenderOption::hits_per_slab, RenderOption::anyhit, "collect");
    if (contains(given, RenderOption::pixel_error) && contains(given, RenderOption::aabb_sigma))
        throw Error(fmt::format("{} does not go with {}",
                                spelled(RenderOption::pixel_error, spelling),
                                spelled(RenderOption::aabb_sigma, spelling)));
    if (input == RenderInput::gaussians) return;
    // Renderers of both models and voxels have options that are for models alone.
    for (const OptionRow& row : option_table())
        if (contains(given, row.option) &&
            std::ranges::find(row.renderers, Renderer::reference) == row.renderers.end())
            throw Error(
                fmt::format("{} is for Gaussians, not for voxels", spelled(row.option, spelling)));
}

}  // namespace vog
