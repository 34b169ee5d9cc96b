// gpu_absent.cpp: The classes of vog/gpu.h in builds without CUDA or OptiX: constructors that throw.
#include "vog/error.h"
#include "vog/gpu.h"

namespace vog {

#ifndef VOG_CUDA
struct CudaSplat::State {};
CudaSplat::CudaSplat(const Gaussians&, double) {
    throw Error("cuda: this build has no CUDA renderer (configure it with -DVOG_CUDA=ON)");
}
CudaSplat::~CudaSplat() = default;
CudaSplat::CudaSplat(CudaSplat&&) noexcept = default;
CudaSplat& CudaSplat::operator=(CudaSplat&&) noexcept = default;
DepthImage CudaSplat::render(const Camera&, int, int) { return {}; }
double CudaSplat::gpu_ms() const { return 0; }
#endif

#ifndef VOG_OPTIX
namespace {
[[noreturn]] void no_optix() {
    throw Error("optix: this build has no OptiX renderers (configure it with -DVOG_OPTIX=ON)");
}
}  // namespace

struct OptixModel::State {};
OptixModel::OptixModel(const Gaussians&, const TraceSceneOptions&) { no_optix(); }
OptixModel::~OptixModel() = default;
OptixModel::OptixModel(OptixModel&&) noexcept = default;
OptixModel& OptixModel::operator=(OptixModel&&) noexcept = default;
DepthImage OptixModel::render(const Camera&, int, int, const TraceOptions&, TraceReport*, int) {
    return {};
}
double OptixModel::gpu_ms() const { return 0; }

struct OptixVolume::State {};
OptixVolume::OptixVolume(std::span<const std::byte>) { no_optix(); }
OptixVolume::~OptixVolume() = default;
OptixVolume::OptixVolume(OptixVolume&&) noexcept = default;
OptixVolume& OptixVolume::operator=(OptixVolume&&) noexcept = default;
DepthImage OptixVolume::render(const Camera&, int, int, int) { return {}; }
double OptixVolume::gpu_ms() const { return 0; }
#endif

}  // namespace vog
