// share_sums.h: the two passes over voxels that are divided among Gaussians: planes of fields, then what they leave.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "convert/fields/field_entries.h"
#include "convert/fields/soft_division.h"
#include "vog/gaussians.h"
#include "vog/voxel_field.h"

namespace vog::joint {

/// Positions of one Gaussian's part of the voxels in world units, relative to the Gaussian's mean.
struct WorldSums {
    double mass = 0;
    Vec3d first;
    Mat3 second{{Vec3d{}, Vec3d{}, Vec3d{}}};
};

/// Fields at voxels that are divided among the Gaussians of a model.
struct SharedFields {
    const Gaussians& model;
    std::span<const Volume> levels;
    const std::deque<SoftDivision>& divisions;          ///< [levels]
    std::span<const std::vector<VoxelField>> fields{};  ///< [fields][levels]
    const Layout& layout;                               ///< of the fields
};

/// Planes of all components about the Gaussians' means, and the positions of their parts.
struct SharePlanes {
    BigVector<WorldPlane> planes;    ///< [Gaussians][components]
    BigVector<WorldSums> positions;  ///< [Gaussians]
};
/// First pass. Gaussians without a voxel have the mean of the field.
SharePlanes find_planes(const SharedFields& shared);
/// Second pass.
/// returns  sums of residuals, [Gaussians][Layout::residual_sums], mass in world units
BigVector<double> find_residuals(const SharedFields& shared, const BigVector<WorldPlane>& planes);

}  // namespace vog::joint
