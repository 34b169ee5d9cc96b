// cuda_renderer.cpp: CudaSplat: the model and the picture in GPU memory.
#include "render/gpu/cuda_memory.h"
#include "render/gpu/cuda_model.h"
#include "render/gpu/cuda_passes.h"
#include "render/trace/trace_model.h"
#include "vog/gpu.h"

namespace vog {

using namespace gpu;
using namespace trace;

struct CudaSplat::State {
    CudaModel model;
    std::int32_t count = 0;
    GpuArray<device::SplatGaussian> gaussians;
    SplatPasses passes;
    GpuArray<float> depth;
    GpuTimer timer;
};

CudaSplat::CudaSplat(const Gaussians& gaussians, double kappa) {
    CudaModel model = cuda_model(gaussians, kappa);
    require_cuda();
    state_ = std::make_unique<State>();
    State& s = *state_;
    s.model = std::move(model);
    s.count = static_cast<std::int32_t>(s.model.gaussians.size());
    s.gaussians = GpuArray(s.model.gaussians, "Gaussians");
    s.model.gaussians = {};
    s.passes = SplatPasses(s.count);
}

CudaSplat::~CudaSplat() = default;
CudaSplat::CudaSplat(CudaSplat&&) noexcept = default;
CudaSplat& CudaSplat::operator=(CudaSplat&&) noexcept = default;

double CudaSplat::gpu_ms() const { return state_->timer.ms(); }

DepthImage CudaSplat::render(const Camera& camera, int width, int height) {
    State& s = *state_;
    const device::Camera frame =
        scene_camera(relative_to(frame_of(camera, width, height), s.model.origin), s.model.unit);
    DepthImage image(width, height);
    if (s.count == 0) return image;
    s.depth.reserve(image.depth.size(), "the picture");

    s.timer.start();
    s.passes.draw(s.gaussians.data(), s.model.kernel, frame, s.depth.data());
    s.timer.stop();
    s.depth.copy_to(image.depth.data(), image.depth.size(), "fetching the picture");
    return image;
}

}  // namespace vog
