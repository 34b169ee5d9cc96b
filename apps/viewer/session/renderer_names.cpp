// renderer_names.cpp: The window's renderers: OpenGL and those of the library.
#include "session/renderer_names.h"

#include <fmt/core.h>

#include "vog/error.h"
#include "vog/renderer.h"

namespace vog::viewer {

namespace {

struct Named {
    Renderer renderer;
    const char* name;
    const char* word() const {
        return renderer == Renderer::gl ? "gl" : info_of(library_renderer(renderer)).name;
    }
    bool built() const {
        return renderer == Renderer::gl || info_of(library_renderer(renderer)).built;
    }
};
constexpr Named kRenderers[] = {
    {Renderer::gl, "OpenGL"}, {Renderer::splat, "CPU splat"}, {Renderer::trace, "CPU rays"},
    {Renderer::cuda, "CUDA"}, {Renderer::optix, "OptiX"},     {Renderer::voxels, "voxels"},
};

}  // namespace

vog::Renderer library_renderer(Renderer renderer) {
    switch (renderer) {
        case Renderer::trace:
            return vog::Renderer::trace;
        case Renderer::cuda:
            return vog::Renderer::cuda;
        case Renderer::optix:
            return vog::Renderer::optix;
        case Renderer::voxels:
            return vog::Renderer::reference;
        default:
            return vog::Renderer::splat;
    }
}

std::vector<Renderer> renderers() {
    std::vector<Renderer> all;
    for (const Named& named : kRenderers)
        if (named.built()) all.push_back(named.renderer);
    return all;
}

const char* name_of(Renderer renderer) {
    for (const Named& named : kRenderers)
        if (named.renderer == renderer) return named.name;
    return "";
}

Renderer renderer_from(const std::string& name) {
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
