// optix_pipeline.h: Host side of OptiX: device context, module, programs, shader binding table,
// acceleration structures. OptiX's driver library is loaded at run time, by optixInit.
#pragma once

#include <optix.h>

#include <array>
#include <memory>
#include <vector>

#include "render/device/launch.h"
#include "render/gpu/cuda_memory.h"
#include "render/gpu/optix/optix_entry_points.h"
#include "render/trace/trace_model.h"

namespace vog::gpu {

using namespace trace;

/// throws vog::Error "optix: <doing>: <OptiX's message>" unless `code` is success
void check_optix(OptixResult code, const char* doing);

/// OptiX device context on the current CUDA device.
class OptixContext {
  public:
    /// throws vog::Error with one line naming the missing part: driver, GPU, OptiX in the driver
    OptixContext();
    ~OptixContext();
    OptixContext(const OptixContext&) = delete;
    OptixContext& operator=(const OptixContext&) = delete;
    OptixDeviceContext get() const { return context_; }

  private:
    OptixDeviceContext context_ = nullptr;
};

/// Deleter of OptiX's objects.
struct OptixDestroy {
    void operator()(OptixModule module) const;
    void operator()(OptixProgramGroup group) const;
    void operator()(OptixPipeline pipeline) const;
};
template <class Handle>
using OptixOwned = std::unique_ptr<std::remove_pointer_t<Handle>, OptixDestroy>;

/// Module, program groups, pipeline and shader binding table of one set of entry points.
class OptixRayPipeline {
  public:
    OptixRayPipeline(const OptixContext& context, const OptixEntryPoints& entry_points);

    /// Launches one ray a pixel of launch.camera on the default stream, asynchronously.
    void run(const device::Launch& launch);

  private:
    struct alignas(OPTIX_SBT_RECORD_ALIGNMENT) Record {
        std::array<char, OPTIX_SBT_RECORD_HEADER_SIZE> header;
    };
    void make_groups(const OptixContext& context, const OptixEntryPoints& entry_points);
    void link(const OptixContext& context);
    void bind();

    OptixOwned<OptixModule> module_;
    std::array<OptixOwned<OptixProgramGroup>, 3> groups_;  ///< ray generation, miss, hit
    OptixOwned<OptixPipeline> pipeline_;
    GpuArray<Record> records_;
    OptixShaderBindingTable table_{};
    GpuArray<device::Launch> launch_;
};

/// Compacted geometry acceleration structure over boxes, under an instance acceleration structure of
/// one instance.
class OptixHierarchy {
  public:
    OptixHierarchy(const OptixContext& context, const std::vector<FloatBox>& boxes);
    OptixTraversableHandle handle() const { return top_; }

  private:
    /// Builds one acceleration structure.
    /// compact  copy it to a buffer of its compacted size
    OptixTraversableHandle build(const OptixContext& context, const OptixBuildInput& input,
                                 bool compact, GpuArray<std::byte>& out);
    GpuArray<std::byte> bottom_nodes_, top_nodes_;
    OptixTraversableHandle bottom_ = 0, top_ = 0;
};

}  // namespace vog::gpu
