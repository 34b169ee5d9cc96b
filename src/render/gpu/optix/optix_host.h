// optix_host.h: OptiX's host interface: checked calls, owners of its objects, the device they belong to. OptiX's
// driver library is loaded at run time, by optixInit.
#pragma once

#include <optix.h>

#include <memory>

#include "render/gpu/optix/optix_pipeline.h"

namespace vog::gpu {

/// throws vog::Error "optix: <doing>: <OptiX's message>" unless `code` is success
void check_optix(OptixResult code, const char* doing);

/// Deleter of OptiX's objects.
struct OptixDestroy {
    void operator()(OptixDeviceContext context) const;
    void operator()(OptixModule module) const;
    void operator()(OptixProgramGroup group) const;
    void operator()(OptixPipeline pipeline) const;
};
template <class Handle>
using OptixOwned = std::unique_ptr<std::remove_pointer_t<Handle>, OptixDestroy>;

struct OptixDevice {
    OptixOwned<OptixDeviceContext> context;
    OptixOwned<OptixModule> module;  ///< of optix_programs.cu
};

/// Options that the module and every pipeline share.
OptixPipelineCompileOptions pipeline_options();

}  // namespace vog::gpu
