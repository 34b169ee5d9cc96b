// moment_volumes.h: small volumes made voxel by voxel, and what a model's Gaussian spreads over.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>

#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::test {

/// Sets voxels anywhere; leaves appear as they are needed.
class VolumeMaker {
  public:
    Volume volume;  ///< its leaves are added by finish()

    void set(Vec3i index, float density);
    /// All voxels from `lower` to `upper`, both included.
    void box(Vec3i lower, Vec3i upper, float density);
    Volume finish() const;

  private:
    std::map<std::tuple<int, int, int>, Leaf> leaves_;
};

/// Leaves on both sides of the origin, with some two hundred tries of `share` of their voxels, and
/// two tiles; densities over three decades; a rotated, scaled transform.
Volume random_volume(std::uint64_t seed, double share);

/// Covariance of the truncated kernel of Gaussian i.
Mat3 covariance(const Gaussians& model, std::size_t i);

}  // namespace vog::test
