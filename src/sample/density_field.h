// density_field.h: density fields, and their sampling at voxel centres into sparse volumes.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sample/noise.h"
#include "vog/sample.h"

namespace vog::sampling {

/// Density as a function of world position; 0 outside [-1/2, 1/2]^3.
class DensityField {
  public:
    virtual ~DensityField() = default;
    /// Bounds of the density within `radius` of `center`; equal bounds mean a constant.
    virtual Interval range(Vec3f center, float radius) const = 0;
    /// Density at each point, finite and >= 0.
    virtual void evaluate(const LeafPoints& points, LeafValues density) const = 0;
};

/// Fields of sample_cloud and sample_explosion (vog/sample.h).
/// voxel  edge, world units; finer detail is left out
std::unique_ptr<DensityField> cloud_field(std::uint32_t seed, float voxel);
std::unique_ptr<DensityField> explosion_field(std::uint32_t seed, float voxel);

/// Voxels at or below this density are inactive.
inline constexpr float kFaintestDensity = 0.01f;

/// Volume of the field at voxel centres, options.size voxels per world unit, with tiles where it is
/// constant. The world origin is a corner of eight leaves at every size.
/// throws vog::Error unless the size is in [64, 1024]
Volume sample_field(const DensityField& field, const std::string& source,
                    const SampleOptions& options);

}  // namespace vog::sampling
