// voxel_walk.h: Hierarchical DDA of the SciVis renderer: one ray through a NanoVDB grid, voxel by voxel, exact for
// voxels of constant value.
//
// NanoVDB's own HDDA steps in float and re-enters nodes an epsilon beyond their face, which at index
// 10^4 skips or doubles one voxel in a thousand. Here the next cell follows from the integer
// coordinates of the last one: the neighbour along the axis that was crossed, clamped to the last
// cell along the others, so that no piece of a ray is skipped or counted twice.
#pragma once

#include <nanovdb/NanoVDB.h>

#include "render/device/camera_ray.h"
#include "render/device/half_space.h"

namespace vog::device {

using NanoVoxels = nanovdb::NanoGrid<float>;
using VoxelAccessor = NanoVoxels::AccessorType;
using VoxelLeaf = NanoVoxels::TreeType::LeafNodeType;

/// One axis of the ray in index coordinates, and of its current voxel.
struct WalkAxis {
    double origin, direction, inverse;
    int32_t voxel;

    /// t at which the ray leaves the cell of edge `dim` voxels around `voxel`.
    VOG_HD double leave(int32_t dim) const {
        const int32_t lower = voxel & ~(dim - 1);
        if (direction == 0) return HUGE_VAL;
        return (static_cast<double>(direction > 0 ? lower + dim : lower) - origin) * inverse;
    }
    /// Moves to the next cell at t: to the neighbour if this axis was crossed.
    VOG_HD void advance(double t, double left_at, int32_t dim) {
        const int32_t lower = voxel & ~(dim - 1), upper = lower + dim - 1;
        if (left_at <= t) {
            voxel = direction > 0 ? upper + 1 : lower - 1;
            return;
        }
        const double at = floor(origin + t * direction);
        voxel = static_cast<int32_t>(
            fmin(fmax(at, static_cast<double>(lower)), static_cast<double>(upper)));
    }
};

VOG_HD WalkAxis walk_axis(double origin, double direction, double start, int32_t lower,
                          int32_t upper) {
    // Below this, the ray moves less than a billionth of a voxel across the largest grid: 0.
    WalkAxis axis;
    axis.origin = origin;
    axis.direction = fabs(direction) < 1e-300 ? 0 : direction;
    axis.inverse = 1 / axis.direction;
    const double at = floor(origin + start * direction);
    axis.voxel = static_cast<int32_t>(
        fmin(fmax(at, static_cast<double>(lower)), static_cast<double>(upper)));
    return axis;
}

/// Active voxel, or tile, on a ray.
struct VoxelPiece {
    double first, last;  ///< t, first < last
    double density;
    nanovdb::Coord voxel;   ///< of a tile one in it
    const VoxelLeaf* leaf;  ///< of a voxel; null: a tile
};

/// A ray on its way through a grid.
struct VoxelWalk {
    WalkAxis x, y, z;
    double t, end;

    /// Moves on to the next active voxel.
    /// accessor  of the grid, kept from call to call or new
    /// returns   false at the end
    VOG_HD bool next(const VoxelAccessor& accessor, VoxelPiece& piece);
};

/// origin, direction  in index space plus 1/2: voxel i covers [i, i + 1)
/// part               of the ray that counts, with first >= 0
VOG_HD VoxelWalk walk_of(const NanoVoxels& grid, Double3 origin, Double3 direction, RayPart part) {
    const auto box = grid.indexBBox();
    const Double3 lower{static_cast<double>(box.min()[0]), static_cast<double>(box.min()[1]),
                        static_cast<double>(box.min()[2])};
    const Double3 upper{box.max()[0] + 1.0, box.max()[1] + 1.0, box.max()[2] + 1.0};
    const Double3 inverse{slab_inverse(direction.x), slab_inverse(direction.y),
                          slab_inverse(direction.z)};
    double t = part.first, end = part.last;
    clip_to_box(lower - origin, upper - origin, inverse, t, end);
    return {walk_axis(origin.x, direction.x, t, box.min()[0], box.max()[0]),
            walk_axis(origin.y, direction.y, t, box.min()[1], box.max()[1]),
            walk_axis(origin.z, direction.z, t, box.min()[2], box.max()[2]), t, end};
}

VOG_HD bool VoxelWalk::next(const VoxelAccessor& accessor, VoxelPiece& piece) {
    while (t < end) {
        const nanovdb::Coord voxel(x.voxel, y.voxel, z.voxel);
        const auto dim = static_cast<int32_t>(accessor.getDim(voxel, 0));  // of the constant cell
        const double leave_x = x.leave(dim), leave_y = y.leave(dim), leave_z = z.leave(dim);
        const double leave = fmin(leave_x, fmin(leave_y, leave_z));
        const double begin = t, until = fmin(leave, end);
        t = fmax(t, leave);
        x.advance(leave, leave_x, dim);
        y.advance(leave, leave_y, dim);
        z.advance(leave, leave_z, dim);
        if (!(until > begin && accessor.isActive(voxel))) continue;
        piece = {begin, until, static_cast<double>(accessor.getValue(voxel)), voxel,
                 dim == 1 ? accessor.probeLeaf(voxel) : nullptr};
        return true;
    }
    return false;
}

}  // namespace vog::device
