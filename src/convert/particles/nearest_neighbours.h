// nearest_neighbours.h: exact distances to the k-th nearest neighbour.
#pragma once

#include "data/point_grid.h"

namespace vog::particles {

/// Largest k.
inline constexpr int kMostNeighbours = 64;

/// Distance from each particle to its k-th nearest neighbour, voxels [N]; to the farthest where
/// there are fewer than k others. The same for any number of threads.
/// places         positions in Morton order, voxels
/// share, shares  index and number of the shares that particles are divided into: distances of
///                other shares are 0, so that the results of all shares add up
BigVector<float> neighbour_distances(const BigVector<Vec3f>& places, int k, int share = 0,
                                     int shares = 1);

}  // namespace vog::particles
