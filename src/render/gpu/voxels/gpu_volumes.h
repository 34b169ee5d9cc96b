// gpu_volumes.h: Pictures of voxels on an NVIDIA GPU by OptiX, the paper's SciVis pipeline: the quantities of
// render/reference/reference.h, by the same formulas, in double precision.
#pragma once

#include <memory>
#include <span>

#include "render/reference/reference.h"
#include "vog/field_maps.h"
#include "vog/levels.h"
#include "vog/volume_picture.h"
#include "vog/voxel_field.h"

namespace vog {

/// Renderer of volumes on a GPU, from any number of cameras: NanoVDB grids in GPU memory, walked by a hierarchical DDA in the
/// closest-hit program. Exact for voxels of constant value; several volumes add up. Options of its pictures are those of the
/// reference, whose progress is not called.
class GpuVolumes {
  public:
    /// volumes  copied to the GPU
    /// fields   [volumes] the field at the voxels of each, as of render_field_reference; none: T alone
    /// throws   vog::Error without OptiX, as voxel_grid does, for fields that are not the volumes', for too little GPU memory
    explicit GpuVolumes(std::span<const Volume> volumes, std::span<const VoxelField> fields = {});
    /// Levels of a mesh as the parts that conversions make of them (docs/amr.md): no two overlap. Exact where finer voxels
    /// divide coarser ones; elsewhere a partly hidden voxel has its density times the share that is seen.
    /// fields  [levels.volumes], or none
    explicit GpuVolumes(const Levels& levels, std::span<const VoxelField> fields = {});
    ~GpuVolumes();
    GpuVolumes(GpuVolumes&&) noexcept;
    GpuVolumes& operator=(GpuVolumes&&) noexcept;

    /// As render_reference.
    /// throws  vog::Error as it does, for voxels of several processes, for too little GPU memory; so do all pictures
    DepthImage depth(const Camera& camera, int width, int height,
                     const ReferenceOptions& options = {});
    /// As render_field_reference with Interpolation::constant.
    /// throws  vog::Error for volumes without fields, too
    FieldMaps fields(FieldPart part, const Camera& camera, int width, int height,
                     const ReferenceOptions& options = {});
    /// As render_volume_reference with Interpolation::constant.
    /// throws  vog::Error for more than 32 volumes, too
    VolumeImage volume(const ValueTransfer& transfer, const Camera& camera, int width, int height,
                       const ReferenceOptions& options = {}, const VolumeLook& look = {});
    /// As render_maximum_reference.
    ValueMap maximum(const Camera& camera, int width, int height,
                     const ReferenceOptions& options = {});

    double gpu_ms() const;  ///< device time of the last picture, milliseconds by CUDA events

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace vog
