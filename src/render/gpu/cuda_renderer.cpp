// cuda_renderer.cpp: CudaSplat: the model and the picture in GPU memory.
#include "render/gpu/cuda_memory.h"
#include "render/gpu/cuda_model.h"
#include "render/gpu/cuda_passes.h"
#include "render/gpu/gpu.h"
#include "render/gpu/sums/sums_memory.h"
#include "render/trace/trace_model.h"

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

    /// T of a model that is not empty, in `depth`.
    void draw(const Camera& camera, int width, int height);
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

void CudaSplat::State::draw(const Camera& camera, int width, int height) {
    const device::Camera frame =
        scene_camera(relative_to(frame_of(camera, width, height), model.origin), model.unit);
    depth.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                  "the picture");
    timer.start();
    passes.draw(gaussians.data(), model.kernel, frame, depth.data());
    timer.stop();
}

DepthImage CudaSplat::render(const Camera& camera, int width, int height) {
    State& s = *state_;
    (void)frame_of(camera, width, height);  // its checks
    DepthImage image(width, height);
    if (s.count == 0) return image;
    s.draw(camera, width, height);
    s.depth.copy_to(image.depth.data(), image.depth.size(), "fetching the picture");
    return image;
}

void CudaSplat::render(const Camera& camera, const SumsSize& size, GpuSums& sums) {
    State& s = *state_;
    const int width = lattice(size, &SumsSize::width), height = lattice(size, &SumsSize::height);
    (void)frame_of(camera, width, height);
    SumsPass pass = sums.state().prepare(SumsKind::depth, size, 1);
    if (s.count == 0) return sums.state().clear();
    s.draw(camera, width, height);
    pass.from = s.depth.data();
    GpuSums::State::finish(pass);
}

}  // namespace vog
