// moment_volumes.h: small volumes made voxel by voxel, and covariances of Gaussians.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>

#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::test {

/// Builds a volume from single voxels.
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

/// Up to 40 leaves around the origin, a share of their voxels active, and two tiles; densities over
/// three decades; a rotated transform with unequal scales.
Volume random_volume(std::uint64_t seed, double share);

/// World covariance of the truncated kernel of Gaussian i.
Mat3 covariance(const Gaussians& model, std::size_t i);

}  // namespace vog::test
