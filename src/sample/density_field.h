// density_field.h: a density field sampled at voxel centres into a sparse volume.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sample/noise.h"
#include "vog/sample.h"

namespace vog::sampling {

/// Density as a function of world position: zero outside [-1/2, 1/2]^3.
class DensityField {
  public:
    virtual ~DensityField() = default;
    /// Bounds on the density within `radius` of `center`; equal ones promise a constant.
    virtual Interval range(Vec3f center, float radius) const = 0;
    /// Density at each point, finite and >= 0.
    virtual void evaluate(const LeafPoints& points, LeafValues density) const = 0;
};

/// What vog/sample.h samples, with the detail that voxels of that edge can carry.
std::unique_ptr<DensityField> cloud_field(std::uint32_t seed, float voxel);
std::unique_ptr<DensityField> explosion_field(std::uint32_t seed, float voxel);

/// Voxels at or below this density are inactive.
inline constexpr float kFaintestDensity = 0.01f;

/// The field sampled at the centre of every voxel, options.size voxels per world unit; world zero
/// is the corner of eight leaves at every size. Where the field is constant, tiles.
/// throws vog::Error unless the size is in [64, 1024]
Volume sample_field(const DensityField& field, const std::string& source,
                    const SampleOptions& options);

}  // namespace vog::sampling
