// vog/reference.h: Ground truth: optical depth of the voxels themselves, by rays through a NanoVDB
// tree.
// Exact for voxels of constant value: each piece of a ray belongs to exactly one voxel, and empty
// nodes and constant tiles are crossed in one step. T adds, so several grids make one picture.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/image.h"
#include "vog/levels.h"
#include "vog/progress.h"
#include "vog/volume.h"

namespace vog {

struct Collective;

/// Field between voxel centres.
enum class Interpolation {
    constant,  ///< each active voxel fills its box [i-1/2, i+1/2]^3 with its value
    linear,    ///< trilinear between voxel centres, inactive voxels being 0
};

/// Interpolation of the reference.
struct VoxelGridOptions {
    Interpolation interpolation = Interpolation::constant;
    /// Spacing of samples along a ray, in voxels, for linear interpolation (midpoint rule, error
    /// proportional to its square). 0: exact, two Gauss points in each cell between voxel centres,
    /// where the field along a ray is a cubic.
    double step_voxels = 0.25;
};

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

}  // namespace vog
