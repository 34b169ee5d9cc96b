// renderer_names.h: what can draw a picture of T in the window.
#pragma once

#include <string>
#include <vector>

namespace vog::viewer {

/// All but gl work in a thread of their own; optix and cuda need a build and a machine that has
/// them.
enum class Renderer { gl, splat, trace, cuda, optix, voxels };
/// Of this build, in the order they are offered.
std::vector<Renderer> renderers();
/// "OpenGL", "CPU splat", "CPU rays", "CUDA", "OptiX", "voxels".
const char* name_of(Renderer renderer);
/// "gl", "splat", "trace", "cuda", "optix" or "reference", as scripts have it. throws vog::Error
/// for any other, and for one that this build does not have
Renderer renderer_from(const std::string& name);

}  // namespace vog::viewer
