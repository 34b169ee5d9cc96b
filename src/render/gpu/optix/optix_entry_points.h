// optix_entry_points.h: the device module, and what the host looks for in it. A test finds every
// name here among the entry points of the module.
#pragma once

#include <cstddef>

#include "render/device/launch.h"

namespace vog::gpu {

/// The device module, compiled from optix_programs.cu into this library: PTX, with a final zero.
extern const char kOptixPrograms[];
extern const std::size_t kOptixProgramsBytes;

/// Entry points of one pipeline; null where it has none of a kind.
struct OptixEntryPoints {
    const char *raygen, *miss, *intersection, *anyhit, *closesthit;
};
inline constexpr OptixEntryPoints kAccumulateEntryPoints{VOG_RAYGEN_ACCUMULATE, VOG_MISS_GAUSSIAN,
                                                         VOG_INTERSECTION_GAUSSIAN,
                                                         VOG_ANYHIT_ACCUMULATE, nullptr};
inline constexpr OptixEntryPoints kCollectEntryPoints{
    VOG_RAYGEN_COLLECT, VOG_MISS_GAUSSIAN, VOG_INTERSECTION_GAUSSIAN, VOG_ANYHIT_COLLECT, nullptr};
inline constexpr OptixEntryPoints kVoxelEntryPoints{
    VOG_RAYGEN_VOXELS, VOG_MISS_VOXELS, VOG_INTERSECTION_VOXELS, nullptr, VOG_CLOSESTHIT_VOXELS};

}  // namespace vog::gpu
