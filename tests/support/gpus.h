// gpus.h: The GPU renderers of this machine: emulated ones in builds with VOG_EMULATED_GPU, those of a real GPU in
// builds with VOG_CUDA or VOG_OPTIX; none elsewhere.
#pragma once

#include <gtest/gtest.h>

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

/// A GPU renderer and a way of traversing hierarchies.
struct Gpu {
    std::string name;
    Renderer renderer;
    std::function<void()> prepare;  ///< to be called before each picture
};
/// For pictures by GpuPictures. Emulated, OptiX is listed once for every way of traversing.
std::vector<Gpu> gpus();

/// T by CUDA's splat, and by OptiX's ray tracer with either any-hit program and with a list of hits that overflows at
/// once.
std::vector<std::pair<std::string, GpuRender>> gpu_renderers();

/// Says whether the GPU draws the window's context, and whether buffers of OpenGL can be registered; true unless set.
/// returns  false where the GPU is not an emulated one, which alone can be told
bool share_gl(bool draws, bool registers);

/// Tests of a GPU, skipped without one. They leave no GPU memory behind.
class GpuTest : public testing::Test {
  protected:
    void SetUp() override {
        if (gpus().empty()) GTEST_SKIP() << "needs a GPU, or a build with VOG_EMULATED_GPU";
    }
    void TearDown() override;
};

}  // namespace vog::test
