// optix_entry_points.h: The OptiX device module and the names of its entry points. A test verifies
// that the module has every one of them.
#pragma once

#include <cstddef>

#include "render/device/launch.h"

namespace vog::gpu {

/// Device module compiled from optix_programs.cu and embedded in this library: PTX, zero-terminated.
extern const char kOptixPrograms[];
extern const std::size_t kOptixProgramsBytes;

/// Entry points of one pipeline; null for a kind that it lacks.
struct OptixEntryPoints {
    const char *raygen, *miss, *intersection, *anyhit, *closesthit;
};
inline constexpr OptixEntryPoints kAccumulateEntryPoints{VOG_RAYGEN_ACCUMULATE, VOG_MISS_GAUSSIAN,
                                                         VOG_INTERSECTION_GAUSSIAN,
                                                         VOG_ANYHIT_ACCUMULATE, nullptr};
inline constexpr OptixEntryPoints kCollectEntryPoints{
    VOG_RAYGEN_COLLECT, VOG_MISS_GAUSSIAN, VOG_INTERSECTION_GAUSSIAN, VOG_ANYHIT_COLLECT, nullptr};
inline constexpr OptixEntryPoints kSumsEntryPoints{
    VOG_RAYGEN_SUMS, VOG_MISS_GAUSSIAN, VOG_INTERSECTION_GAUSSIAN, VOG_ANYHIT_SUMS, nullptr};
inline constexpr OptixEntryPoints kSlabsEntryPoints{
    VOG_RAYGEN_SLABS, VOG_MISS_GAUSSIAN, VOG_INTERSECTION_GAUSSIAN, VOG_ANYHIT_SLABS, nullptr};
/// No miss program: rays that miss the box of the grid are not traced.
inline constexpr OptixEntryPoints kVoxelEntryPoints{
    VOG_RAYGEN_VOXELS, nullptr, VOG_INTERSECTION_VOXELS, nullptr, VOG_CLOSESTHIT_VOXELS};

}  // namespace vog::gpu
