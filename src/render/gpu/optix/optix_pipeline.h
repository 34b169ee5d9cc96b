// optix_pipeline.h: OptiX as the renderers see it: the device, pipelines of programs, hierarchies of boxes. No
// OptiX headers here: those are for the sources behind it (optix_host.h).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/device/launch.h"
#include "render/gpu/cuda_memory.h"
#include "render/gpu/optix/optix_entry_points.h"
#include "render/trace/trace_model.h"

namespace vog::gpu {

using namespace trace;

/// Context and compiled device module on the current CUDA device.
struct OptixDevice;

/// OptiX on the current CUDA device: made when first asked for, shared by all models and volumes there, and ended with
/// the last of them. With the environment variable VOG_OPTIX_DEBUG set, OptiX validates what it is given and its
/// messages go to the standard error.
/// throws  vog::Error with one line naming the missing part: driver, GPU, OptiX in the driver
std::shared_ptr<OptixDevice> optix_device();

/// Most primitives that one hierarchy may have: 2^29 on every device so far.
std::size_t most_primitives(const OptixDevice& device);
/// throws  vog::Error for more Gaussians than that
void require_primitives(const OptixDevice& device, std::size_t gaussians);

/// Program groups, pipeline and shader binding table of one set of entry points.
class OptixRayPipeline {
  public:
    OptixRayPipeline(std::shared_ptr<OptixDevice> device, const OptixEntryPoints& entry_points);
    ~OptixRayPipeline();

    /// Launches one ray a pixel of launch.camera on the default stream, asynchronously.
    void run(const device::Launch& launch);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Compacted geometry acceleration structure over boxes, under an instance acceleration structure of
/// one instance.
class OptixHierarchy {
  public:
    OptixHierarchy(std::shared_ptr<OptixDevice> device, const std::vector<FloatBox>& boxes);
    ~OptixHierarchy();
    std::uint64_t handle() const;  ///< Launch::traversable

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace vog::gpu
