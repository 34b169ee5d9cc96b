// field_limits.h: planes of fields that stay within the range of the data.
#pragma once

#include <cstddef>

#include "vog/gaussians.h"

namespace vog {

/// Variance of position along a direction of Gaussian i, times its length squared, without truncation.
double variance_along(const Gaussians& gaussians, std::size_t i, Vec3d direction);
/// Variance of the field's plane over Gaussian i of the model, without its truncation.
double plane_variance(const Gaussians& gaussians, const ScalarField& field, std::size_t i);

/// Scales gradients so that each plane of a scalar field stays within the field's range over its Gaussian's support, and adds
/// the variance that they give up to the residual: the mean and the second moment of a Gaussian's values stay. Planes
/// within the range stay the same bytes, and so do fields without a range (lower = upper).
void limit_planes(Gaussians& model);

}  // namespace vog
