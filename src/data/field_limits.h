// field_limits.h: planes of fields that stay within the range of the data.
#pragma once

#include <cstddef>

#include "vog/gaussians.h"

namespace vog {

/// Variance of the field's plane over Gaussian i of the model, without its truncation.
double plane_variance(const Gaussians& gaussians, const ScalarField& field, std::size_t i);

}  // namespace vog
