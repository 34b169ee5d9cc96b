// renderer_names.cpp: The window's renderers: OpenGL and those of the library.
#include "session/renderer_names.h"

#include <fmt/core.h>

#include "vog/error.h"
#include "vog/renderer.h"

namespace vog::viewer {

namespace {

struct Named {
    WindowRenderer renderer;
    const char* name;
    const char* word() const {
        return renderer == WindowRenderer::gl ? "gl" : info_of(library_renderer(renderer)).name;
    }
    bool built() const {
        return renderer == WindowRenderer::gl || info_of(library_renderer(renderer)).built;
    }
};
constexpr Named kRenderers[] = {
    {WindowRenderer::gl, "OpenGL"},      {WindowRenderer::splat, "CPU splat"},
    {WindowRenderer::trace, "CPU rays"}, {WindowRenderer::cuda, "CUDA"},
    {WindowRenderer::optix, "OptiX"},    {WindowRenderer::voxels, "voxels"},
};

}  // namespace

vog::Renderer library_renderer(WindowRenderer renderer) {
    switch (renderer) {
        case WindowRenderer::trace:
            return vog::Renderer::trace;
        case WindowRenderer::cuda:
            return vog::Renderer::cuda;
        case WindowRenderer::optix:
            return vog::Renderer::optix;
        case WindowRenderer::voxels:
            return vog::Renderer::reference;
        default:
            return vog::Renderer::splat;
    }
}

std::vector<WindowRenderer> renderers() {
    std::vector<WindowRenderer> all;
    for (const Named& named : kRenderers)
        if (named.built()) all.push_back(named.renderer);
    return all;
}

const char* name_of(WindowRenderer renderer) {
    for (const Named& named : kRenderers)
        if (named.renderer == renderer) return named.name;
    return "";
}

WindowRenderer renderer_from(const std::string& name) {
    std::string words;
    for (const Named& named : kRenderers) {
        if (name == named.word() && named.built()) return named.renderer;
        if (name == named.word())
            throw Error(fmt::format("renderer {}: this build has no {}", name, named.name));
        if (named.built()) words += (words.empty() ? "" : ", ") + std::string(named.word());
    }
    throw Error(fmt::format("no renderer '{}' in the window (there are: {})", name, words));
}

}  // namespace vog::viewer
