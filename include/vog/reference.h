// vog/reference.h: the ground truth. Primary rays through the voxels themselves, in a NanoVDB tree.
// Exact for voxels of constant value: every piece of a ray is given to exactly one voxel, and empty
// nodes and constant tiles are crossed in one step. T adds, so several grids make one picture.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "vog/camera.h"
#include "vog/image.h"
#include "vog/levels.h"
#include "vog/progress.h"
#include "vog/volume.h"

namespace vog {

/// What the field is between voxel centres.
enum class Interpolation {
    constant,  ///< each active voxel fills its box [i-1/2, i+1/2]^3 with its value
    linear,    ///< trilinear between voxel centres, inactive voxels being 0
};

struct VoxelGridOptions {
    Interpolation interpolation = Interpolation::constant;
    /// Spacing of samples along a ray, in voxels, for linear interpolation (midpoint rule, error
    /// proportional to its square). 0: exact, two Gauss points in each cell between voxel centres,
    /// where the field along a ray is a cubic.
    double step_voxels = 0.25;
};

/// A volume made ready for rays: a NanoVDB grid of floats, its transform and the field it means.
/// Copies share the grid, which is never changed.
class VoxelGrid {
  public:
    struct Data;
    explicit VoxelGrid(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
    const Data& data() const { return *data_; }
    /// The NanoVDB grid of floats (version 32) in whole, its first byte at a multiple of 32; as
    /// long as this lives.
    std::span<const std::byte> bytes() const;
    std::size_t memory_bytes() const { return bytes().size(); }

  private:
    std::shared_ptr<const Data> data_;
};

/// volume   as its readers deliver it; may be empty
/// throws   vog::Error for a volume that validate() refuses, for overlapping nodes, indices beyond
///          2^30, a step that is neither 0 nor at least 0.001
/// cost     O(leaves log leaves) time, 2.1 kB a leaf
[[nodiscard]] VoxelGrid voxel_grid(const Volume& volume, const VoxelGridOptions& options = {});

/// Optical depth along origin + t direction, t >= 0, at extinction 1, in double precision.
/// direction need not have unit length; T is per world unit of length all the same.
/// throws   vog::Error for a direction that is zero, or anything not finite
[[nodiscard]] double optical_depth(const VoxelGrid& grid, Vec3d origin, Vec3d direction);

/// Levels of an adaptive mesh made ready for rays: every piece of a ray counts in the finest level
/// that is there, or nowhere, exactly, however the levels lie to each other. Copies share the
/// grids.
class LevelGrids {
  public:
    struct Data;
    explicit LevelGrids(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
    const Data& data() const { return *data_; }
    /// Bytes of the NanoVDB grids.
    std::size_t memory_bytes() const;

  private:
    std::shared_ptr<const Data> data_;
};

/// Linear interpolation within a level takes the values of other levels beyond its edge, and ends
/// flat at the faces of the outermost voxels, where a single grid would fade over one voxel.
/// throws   vog::Error as validate(Levels) and voxel_grid do
[[nodiscard]] LevelGrids level_grids(const Levels& levels, const VoxelGridOptions& options = {});
[[nodiscard]] double optical_depth(const LevelGrids& levels, Vec3d origin, Vec3d direction);

struct ReferenceOptions {
    Progress progress{};
};

/// T per pixel at extinction 1, summed over the grids.
/// returns  within 1e-6 relative of the exact sum; the same bytes for any number of threads
/// throws   vog::Error for an unusable camera or size
/// cost     O(pixels * nodes crossed)
[[nodiscard]] DepthImage render_reference(std::span<const VoxelGrid> grids, const Camera& camera,
                                          int width, int height,
                                          const ReferenceOptions& options = {});
[[nodiscard]] DepthImage render_reference(const LevelGrids& levels, const Camera& camera, int width,
                                          int height, const ReferenceOptions& options = {});

}  // namespace vog
