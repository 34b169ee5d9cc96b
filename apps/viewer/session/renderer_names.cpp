// renderer_names.cpp: the renderers' names, and which of them are built.
#include "session/renderer_names.h"

#include <fmt/core.h>

#include "vog/error.h"

namespace vog::viewer {

namespace {

struct Named {
    Renderer renderer;
    const char* word;
    const char* name;
    bool built;
};
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
constexpr Named kRenderers[] = {
    {Renderer::gl, "gl", "OpenGL", true},         {Renderer::splat, "splat", "CPU splat", true},
    {Renderer::trace, "trace", "CPU rays", true}, {Renderer::cuda, "cuda", "CUDA", kCuda},
    {Renderer::optix, "optix", "OptiX", kOptix},  {Renderer::voxels, "reference", "voxels", true},
};

}  // namespace

std::vector<Renderer> renderers() {
    std::vector<Renderer> all;
    for (const Named& named : kRenderers)
        if (named.built) all.push_back(named.renderer);
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
        if (name == named.word && named.built) return named.renderer;
        if (name == named.word)
            throw Error(fmt::format("renderer {}: this build has no {}", name, named.name));
        if (named.built) words += (words.empty() ? "" : ", ") + std::string(named.word);
    }
    throw Error(fmt::format("no renderer '{}' in the window (there are: {})", name, words));
}

}  // namespace vog::viewer
