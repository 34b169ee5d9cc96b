// emulated_gpu.h: The GPU renderers in builds with VOG_EMULATED_GPU; none in others.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/renderer.h"

namespace vog::test {

using GpuRender = std::function<DepthImage(const Gaussians&, const Camera&, int, int)>;

/// CUDA's splat, and OptiX's ray tracer with either any-hit program and with a list of hits that overflows at
/// once, in every way of traversing a hierarchy.
std::vector<std::pair<std::string, GpuRender>> emulated_gpu_renderers();

/// A GPU renderer and a way of traversing hierarchies.
struct EmulatedGpu {
    std::string name;
    Renderer renderer;
    std::function<void()> prepare;  ///< to be called before each picture
};
/// For pictures by GpuPictures.
std::vector<EmulatedGpu> emulated_gpus();

/// Whether the emulated GPU draws the window's context, and whether buffers of OpenGL can be registered; true unless set.
void share_gl(bool draws, bool registers);

}  // namespace vog::test
