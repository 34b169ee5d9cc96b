// gpu_absent.cpp: The classes of the GPU renderers in builds without CUDA or OptiX: constructors that throw.
#include "render/gpu/chords/chord_tracer.h"
#include "render/gpu/chords/gpu_pictures.h"
#include "render/gpu/gpu.h"
#include "render/gpu/sums/gpu_sums.h"
#include "render/gpu/voxels/gpu_volumes.h"
#include "vog/error.h"

namespace vog {

#ifndef VOG_OPTIX
namespace {
[[noreturn]] void no_optix() {
    throw Error("optix: this build has no OptiX renderers (configure it with -DVOG_OPTIX=ON)");
}
}  // namespace
#endif

#ifndef VOG_CUDA
namespace {
[[noreturn]] void no_cuda() {
    throw Error("cuda: this build has no CUDA renderer (configure it with -DVOG_CUDA=ON)");
}
}  // namespace

struct CudaSplat::State {};
CudaSplat::CudaSplat(const Gaussians&, double) { no_cuda(); }
CudaSplat::~CudaSplat() = default;
CudaSplat::CudaSplat(CudaSplat&&) noexcept = default;
CudaSplat& CudaSplat::operator=(CudaSplat&&) noexcept = default;
DepthImage CudaSplat::render(const Camera&, int, int) { return {}; }
void CudaSplat::render(const Camera&, const SumsSize&, GpuSums&) {}
double CudaSplat::gpu_ms() const { return 0; }

struct GpuPictures::State {};
GpuPictures::GpuPictures(Renderer renderer, const Gaussians&, const TraceSceneOptions&) {
    if (renderer == Renderer::optix) no_optix();
    no_cuda();
}
GpuPictures::~GpuPictures() = default;
GpuPictures::GpuPictures(GpuPictures&&) noexcept = default;
GpuPictures& GpuPictures::operator=(GpuPictures&&) noexcept = default;
DepthImage GpuPictures::depth(const Camera&, int, int, const Clipping&) { return {}; }
FieldMaps GpuPictures::fields(const FieldChoice&, const Camera&, int, int, const Clipping&) {
    return {};
}
VolumeImage GpuPictures::volume(const std::string&, const ValueTransfer&, const Camera&, int, int,
                                int, const VolumeLook&, std::vector<Rgba>) {
    return {};
}
ValueMap GpuPictures::maximum(const std::string&, const Camera&, int, int, int, const Clipping&) {
    return {};
}
void GpuPictures::depth(const Camera&, const SumsSize&, GpuSums&, const Clipping&) {}
void GpuPictures::fields(const FieldChoice&, const SumsUnit&, const Camera&, const SumsSize&,
                         GpuSums&, const Clipping&) {}
void GpuPictures::volume(const std::string&, const ValueTransfer&, const Camera&, const SumsSize&,
                         GpuSums&, int, const VolumeLook&) {}
void GpuPictures::maximum(const std::string&, const SumsUnit&, const Camera&, const SumsSize&,
                          GpuSums&, int, const Clipping&) {}
double GpuPictures::gpu_ms() const { return 0; }

struct GpuSums::State {};
GpuSums::GpuSums() = default;
GpuSums::~GpuSums() = default;
GpuSums::GpuSums(GpuSums&&) noexcept = default;
GpuSums& GpuSums::operator=(GpuSums&&) noexcept = default;
int GpuSums::width() const { return 0; }
int GpuSums::height() const { return 0; }
int GpuSums::channels() const { return 0; }
std::vector<float> GpuSums::fetch() const { return {}; }
#elif !defined(VOG_OPTIX)
struct gpu::ChordTracer::State {};
gpu::ChordTracer::ChordTracer(const std::vector<trace::FloatBox>&) { no_optix(); }
gpu::ChordTracer::~ChordTracer() = default;
void gpu::ChordTracer::run(device::Launch) {}
#endif

#ifndef VOG_CUDA_GL
bool GlSumsBuffer::possible() { return false; }
struct GlSumsBuffer::State {};
GlSumsBuffer::GlSumsBuffer(unsigned) {
    throw Error("cuda: this build has no buffers of OpenGL (GL/gl.h was not found)");
}
GlSumsBuffer::~GlSumsBuffer() = default;
GlSumsBuffer::GlSumsBuffer(GlSumsBuffer&&) noexcept = default;
GlSumsBuffer& GlSumsBuffer::operator=(GlSumsBuffer&&) noexcept = default;
void GlSumsBuffer::copy(const GpuSums&) {}
#endif

#ifndef VOG_OPTIX

struct OptixModel::State {};
OptixModel::OptixModel(const Gaussians&, const TraceSceneOptions&) { no_optix(); }
OptixModel::~OptixModel() = default;
OptixModel::OptixModel(OptixModel&&) noexcept = default;
OptixModel& OptixModel::operator=(OptixModel&&) noexcept = default;
DepthImage OptixModel::render(const Camera&, int, int, const TraceOptions&, TraceReport*, int) {
    return {};
}
void OptixModel::render(const Camera&, const SumsSize&, GpuSums&, const TraceOptions&) {}
double OptixModel::gpu_ms() const { return 0; }

struct OptixVolume::State {};
OptixVolume::OptixVolume(std::span<const std::byte>) { no_optix(); }
OptixVolume::~OptixVolume() = default;
OptixVolume::OptixVolume(OptixVolume&&) noexcept = default;
OptixVolume& OptixVolume::operator=(OptixVolume&&) noexcept = default;
DepthImage OptixVolume::render(const Camera&, int, int, int) { return {}; }
double OptixVolume::gpu_ms() const { return 0; }

struct GpuVolumes::State {};
GpuVolumes::GpuVolumes(std::span<const Volume>, std::span<const VoxelField>) { no_optix(); }
GpuVolumes::GpuVolumes(const Levels&, std::span<const VoxelField>) { no_optix(); }
GpuVolumes::~GpuVolumes() = default;
GpuVolumes::GpuVolumes(GpuVolumes&&) noexcept = default;
GpuVolumes& GpuVolumes::operator=(GpuVolumes&&) noexcept = default;
DepthImage GpuVolumes::depth(const Camera&, int, int, const ReferenceOptions&) { return {}; }
FieldMaps GpuVolumes::fields(FieldPart, const Camera&, int, int, const ReferenceOptions&) {
    return {};
}
VolumeImage GpuVolumes::volume(const ValueTransfer&, const Camera&, int, int,
                               const ReferenceOptions&, const VolumeLook&) {
    return {};
}
ValueMap GpuVolumes::maximum(const Camera&, int, int, const ReferenceOptions&) { return {}; }
double GpuVolumes::gpu_ms() const { return 0; }
#endif

}  // namespace vog
