// nearest_neighbours.h: how far the k-th neighbour of each particle is.
#pragma once

#include "data/point_grid.h"

namespace vog::particles {

inline constexpr int kMostNeighbours = 64;

/// Distance from each particle of the grid, in its order, to its k-th neighbour, voxels. Where
/// there are no k others: to the farthest. The same for any number of threads.
/// places  of the grid's particles, in voxels
/// share, shares  for those of this share alone, 0 for the others: the shares' results add up
BigVector<float> neighbour_distances(const BigVector<Vec3f>& places, int k, int share = 0,
                                     int shares = 1);

}  // namespace vog::particles
