// empty_space.h: where the voxels of a cell lie, and whether its Gaussian would bridge the space
// between them.
// A Gaussian over two separate things puts mass where the data have none. A standard deviation of
// their sum that covers the gap blurs it, as it blurs all detail of that size; a smaller one, as of
// two voxels far apart, draws one thing where there are two.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "convert/moments/cells/bricks.h"
#include "convert/moments/gaussian_moments.h"

namespace vog::moments {

/// Bounds of the voxels with mass of a cell, index space. The default is all of space: no gaps.
struct Extent {
    Vec3d lower = Vec3d{-kAll, -kAll, -kAll}, upper = Vec3d{kAll, kAll, kAll};
    double voxel = 0;  ///< edge of the smallest voxel, in units of the index space

  private:
    static constexpr double kAll = std::numeric_limits<double>::infinity();
};
/// Extents of the octants of a cell; of those without mass any.
using Extents = std::array<Extent, 8>;

/// Extent of the octants in a mask other than 0.
Extent joined_extents(const Extents& octants, std::uint8_t mask);

/// Whether the empty space between two parts of a cell is wider along an axis than the standard
/// deviation of the whole.
/// whole  moments of both parts
bool bridges(const Moments& whole, const Extent& a, const Extent& b);

/// Extents of the nodes of a brick's octree: kBrickNodes. Nodes without mass have any.
std::array<Extent, kBrickNodes> brick_extents(const Brick& brick);

}  // namespace vog::moments
