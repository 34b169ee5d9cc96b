// renderer_names.h: Names of the renderers that the window offers.
#pragma once

#include <string>
#include <vector>

#include "vog/renderer.h"

namespace vog::viewer {

/// OpenGL, and the library's renderers, which draw in a thread of their own; cuda and optix need a
/// build and a machine with an NVIDIA GPU.
enum class WindowRenderer { gl, splat, trace, cuda, optix, voxels };
/// Renderers of this build, in the order to offer them in.
std::vector<WindowRenderer> renderers();
/// Whether a GPU draws without OpenGL; it adds up the rays of a pixel itself.
inline bool on_gpu(WindowRenderer renderer) {
    return renderer == WindowRenderer::cuda || renderer == WindowRenderer::optix;
}
/// The library's renderer of that name, reference for voxels. Not for gl
vog::Renderer library_renderer(WindowRenderer renderer);
/// "OpenGL", "CPU splat", "CPU rays", "CUDA", "OptiX", "voxels".
const char* name_of(WindowRenderer renderer);
/// The renderer that scripts call "gl", "splat", "trace", "cuda", "optix" or "reference".
/// throws vog::Error for any other name, and for a renderer that this build lacks
WindowRenderer renderer_from(const std::string& name);

}  // namespace vog::viewer
