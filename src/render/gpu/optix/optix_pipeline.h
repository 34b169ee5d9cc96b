// optix_pipeline.h: OptiX on the host: device context, module, programs, shader binding table,
// hierarchy. OptiX's driver library is loaded at run time, by optixInit.
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

/// throws vog::Error "optix: <doing>: <what OptiX says>" unless `code` is success
void check_optix(OptixResult code, const char* doing);

/// OptiX on the current CUDA device.
class OptixContext {
  public:
    /// throws vog::Error with one line that says what is missing: driver, GPU, OptiX in the driver
    OptixContext();
    ~OptixContext();
    OptixContext(const OptixContext&) = delete;
    OptixContext& operator=(const OptixContext&) = delete;
    OptixDeviceContext get() const { return context_; }

  private:
    OptixDeviceContext context_ = nullptr;
};

/// Frees OptiX's objects.
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

    /// One ray a pixel of launch.camera, on the default stream; does not wait.
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

/// A compacted GAS over boxes, instanced once by an IAS.
class OptixHierarchy {
  public:
    OptixHierarchy(const OptixContext& context, const std::vector<FloatBox>& boxes);
    OptixTraversableHandle handle() const { return top_; }

  private:
    /// Builds and, where that is allowed, compacts.
    OptixTraversableHandle build(const OptixContext& context, const OptixBuildInput& input,
                                 bool compact, GpuArray<std::byte>& out);
    GpuArray<std::byte> bottom_nodes_, top_nodes_;
    OptixTraversableHandle bottom_ = 0, top_ = 0;
};

}  // namespace vog::gpu
