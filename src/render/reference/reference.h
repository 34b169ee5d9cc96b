// reference.h: Ground truth: optical depth of the voxels themselves, by rays through a NanoVDB
// tree.
// Exact for voxels of constant value: each piece of a ray belongs to exactly one voxel, and empty
// nodes and constant tiles are crossed in one step. T adds, so several grids make one picture.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "render/by_value/volume_image.h"
#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/field_maps.h"
#include "vog/image.h"
#include "vog/levels.h"
#include "vog/progress.h"
#include "vog/renderer.h"
#include "vog/value_transfer.h"
#include "vog/volume.h"
#include "vog/volume_picture.h"
#include "vog/voxel_field.h"

namespace vog {

struct Collective;

/// A volume prepared for rays: a NanoVDB grid of floats, its transform and its interpolation.
/// Immutable; copies share the grid.
class VoxelGrid {
  public:
    struct Data;
    explicit VoxelGrid(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
    const Data& data() const { return *data_; }
    /// The whole NanoVDB grid of floats (version 32), aligned to 32 bytes, valid while this lives.
    std::span<const std::byte> bytes() const;
    std::size_t memory_bytes() const { return bytes().size(); }

  private:
    std::shared_ptr<const Data> data_;
};

/// Prepares a volume for rays.
/// volume   leaves sorted by origin, as readers return them; may be empty
/// throws   vog::Error for a volume that validate() refuses, for overlapping nodes, indices beyond
///          2^30, a step that is neither 0 nor at least 0.001
/// cost     O(leaves log leaves) time, 2.1 kB a leaf
[[nodiscard]] VoxelGrid voxel_grid(const Volume& volume, const VoxelGridOptions& options = {});

/// Optical depth along origin + t direction, t >= 0, at extinction 1, in double precision.
/// direction  of any length > 0; T does not depend on its length
/// throws   vog::Error for a direction that is zero, or anything not finite
[[nodiscard]] double optical_depth(const VoxelGrid& grid, Vec3d origin, Vec3d direction);

/// Levels of an adaptive mesh prepared for rays: each piece of a ray counts in the finest level
/// that is active there and in no other, exactly, for any offset, angle and ratio between the levels.
/// Immutable; copies share the grids.
class LevelGrids {
  public:
    struct Data;
    explicit LevelGrids(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
    const Data& data() const { return *data_; }
    /// Bytes of all NanoVDB grids.
    std::size_t memory_bytes() const;

  private:
    std::shared_ptr<const Data> data_;
};

/// Prepares levels for rays. Linear interpolation uses values of the neighbouring levels beyond a
/// level's edge; at the mesh's own boundary the field is constant up to the faces of the outermost
/// voxels, where a single grid would fade to 0 over one voxel.
/// throws   vog::Error as validate(Levels) and voxel_grid do
[[nodiscard]] LevelGrids level_grids(const Levels& levels, const VoxelGridOptions& options = {});
[[nodiscard]] double optical_depth(const LevelGrids& levels, Vec3d origin, Vec3d direction);

/// Options of one picture.
struct ReferenceOptions {
    Progress progress{};  ///< called with the finished fraction of the picture
    /// N: a pixel is the mean T of N x N rays, through the centres of N x N equal parts of it,
    /// [1, 64]. 1: the ray through its centre.
    int samples = 1;
    Clipping clip{};  ///< space that counts; exact on every ray
    /// Processes that each have a part of the voxels and make the same calls (vog-mpi), for maps of fields, maxima and
    /// pictures by value, which are complete on the root; T adds without it. Null: this process has all voxels.
    const Collective* collective = nullptr;
    /// For estimates, of T and pictures by value: pixels other than those of is_fifth() (render/pixel_tiles.h) may be left 0.
    bool fifth = false;
};

/// Optical depth T per pixel at extinction 1, summed over the grids.
/// returns  within 1e-6 relative of the exact sum; the same bytes for any number of threads
/// throws   vog::Error for an unusable camera or size, or samples out of range
/// cost     O(pixels * samples^2 * nodes crossed)
[[nodiscard]] DepthImage render_reference(std::span<const VoxelGrid> grids, const Camera& camera,
                                          int width, int height,
                                          const ReferenceOptions& options = {});
[[nodiscard]] DepthImage render_reference(const LevelGrids& levels, const Camera& camera, int width,
                                          int height, const ReferenceOptions& options = {});

/// The voxels' own maps. With Interpolation::constant each voxel is a box with its density and field, with
/// linear a tent over the eight voxels around (trilinear density; at a point the field has the values of those
/// voxels, by their weights times density).
/// Several volumes are added up; samples are those of ReferenceOptions.
/// volumes  the measures
/// fields   [volumes] the field at the voxels of each; a component with neither leaves nor tiles is the volume's
///          own values
/// part     FieldPart::value for scalar fields, another for vector fields
/// throws   vog::Error as voxel_grid and render_reference do, and for fields that are not the volumes'
[[nodiscard]] FieldMaps render_field_reference(std::span<const Volume> volumes,
                                               std::span<const VoxelField> fields, FieldPart part,
                                               const Camera& camera, int width, int height,
                                               const ReferenceOptions& options = {},
                                               const VoxelGridOptions& voxels = {});
/// The same of the levels of a mesh: at every point the finest counts alone (level_grids). Interpolated, and
/// where a voxel is hidden in part, moments of the field are stored in floats: deviations below 3e-4 of the
/// mean's distance from the field's least value are rounding.
/// fields  [levels.volumes]
[[nodiscard]] FieldMaps render_field_reference(const Levels& levels,
                                               std::span<const VoxelField> fields, FieldPart part,
                                               const Camera& camera, int width, int height,
                                               const ReferenceOptions& options = {},
                                               const VoxelGridOptions& voxels = {});
/// The same of parts of levels, which add up: of each level as read_level_parts in vog/distributed.h has it.
/// fields  [parts][levels of the part]
[[nodiscard]] FieldMaps render_field_reference(std::span<const Levels* const> parts,
                                               std::span<const std::span<const VoxelField>> fields,
                                               FieldPart part, const Camera& camera, int width,
                                               int height, const ReferenceOptions& options = {},
                                               const VoxelGridOptions& voxels = {});

/// Voxels of other processes (ReferenceOptions::collective), as far as one knows of them.
struct OtherVoxels {
    /// Whether volumes may overlap those of other processes: extinctions then add up, and all pieces of a ray are sent
    /// in place of runs of them.
    bool overlap = true;
    /// [volumes] voxels next to this process's, on the same lattice, for light by gradients; empty: none
    std::span<const Volume> beside{};
    std::span<const VoxelField> field{};  ///< [beside]
};
/// The voxels' own picture: constant in each voxel, exponentials per cell.
/// volumes  the measures; one, or the parts of a mesh, which do not overlap
/// fields   [volumes] a scalar field at the voxels of each; a component with neither leaves nor tiles is the
///          volume's own values, whose extinction is not weighed by density
/// Where several volumes overlap, their extinctions add up. options.clip and look.clip both cut.
/// voxels   Interpolation::linear: of one volume; values are interpolated, then classified (post-classification), at
///          the middles of steps of step_voxels > 0; light is by the gradient of the interpolated field
/// others   of several processes, which must have the same transfer function, and constant voxels
/// returns  constant voxels: within 1e-6 of the exact picture; the same bytes for any number of threads
/// throws   vog::Error as render_field_reference, validate(look) and validate(transfer) do
/// cost     O(pixels * samples^2 * voxels on a ray), about 10 ns for each that absorbs
[[nodiscard]] VolumeImage render_volume_reference(
    std::span<const Volume> volumes, std::span<const VoxelField> fields,
    const ValueTransfer& transfer, const Camera& camera, int width, int height,
    const ReferenceOptions& options = {}, const VolumeLook& look = {},
    const VoxelGridOptions& voxels = {}, const OtherVoxels& others = {});
/// Such pictures, unlit, of constant voxels, from several cameras under several transfer functions: each ray is walked once.
/// options  whether fifth; no clip, one process
/// returns  [cameras][transfers]
[[nodiscard]] std::vector<std::vector<VolumeImage>> render_volume_references(
    std::span<const Volume> volumes, std::span<const VoxelField> fields,
    std::span<const ValueTransfer> transfers, std::span<const Camera> cameras, int width,
    int height, const ReferenceOptions& options = {});
/// Largest value of the voxels on the ray through each pixel, exactly: constant in each voxel, all active voxels.
/// volumes  as of render_volume_reference
/// options  samples: mean over those rays of a pixel that meet voxels
/// returns  NaN where a pixel meets no active voxel
/// throws   vog::Error as render_volume_reference does
[[nodiscard]] ValueMap render_maximum_reference(std::span<const Volume> volumes,
                                                std::span<const VoxelField> fields,
                                                const Camera& camera, int width, int height,
                                                const ReferenceOptions& options = {});

}  // namespace vog
