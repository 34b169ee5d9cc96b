// point_neighbours.h: how far the k-th neighbour of each particle is.
#pragma once

#include <vector>

#include "point_grid.h"

namespace vog {

inline constexpr int kMostNeighbours = 64;

/// Distance from each particle of the grid, in its order, to its k-th neighbour, voxels. Where
/// there are no k others: to the farthest. The same for any number of threads.
/// places  of the grid's particles, in voxels
std::vector<float> neighbour_distances(const std::vector<Vec3f>& places, int k);

}  // namespace vog
