// octree.h: the moment octree: mass, mean and covariance of every aligned cube of 8 voxels or more.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "convert/moments/cells/bricks.h"
#include "convert/moments/gaussian_moments.h"

namespace vog::moments {

/// One node: moments of the voxels inside the cube [origin, origin + edge), index space.
/// Lengths in voxels, mass in density times voxels. Voxels are boxes of constant density.
struct MomentCell {
    Vec3i origin;                       ///< multiples of the level's edge
    float mass = 0;                     ///< > 0
    Vec3f mean;                         ///< relative to the centre of the cube
    std::array<float, 6> covariance{};  ///< xx xy xz yy yz zz
    std::uint32_t first_child = 0;      ///< index in the next finer level
    std::uint32_t child_count = 0;      ///< 0: the cell is a brick
};

/// All occupied cells of one size.
struct MomentLevel {
    int edge_log2 = 3;              ///< edge of a cell: 2^edge_log2 voxels
    std::vector<MomentCell> cells;  ///< in Morton order, so the children of a cell are contiguous
};

/// Levels from 8 voxels to one cell that contains everything.
struct MomentOctree {
    std::vector<MomentLevel> levels;  ///< finest first; none without mass
};

/// Builds the octree bottom up: a parent's moments are the sum of its children's.
/// bricks     disjoint, in Morton order
/// least_top  edge of the coarsest level at least, voxels; a power of two
MomentOctree brick_octree(std::span<const Brick> bricks, double least_top = 1);

/// Moments of a cell with its mean in index space.
Moments cell_moments(const MomentCell& cell, int edge_log2);

}  // namespace vog::moments
