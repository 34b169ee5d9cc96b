// field_models.h: models with fields.
#pragma once

#include <cstdint>

#include "vog/gaussians.h"
#include "vog/value_transfer.h"

namespace vog::test {

/// Gives a model the scalar fields "temperature" and "density", a name of its own properties, and the vector field
/// "gas velocity", all random; with units and ranges that have no short decimal form.
void add_random_fields(Gaussians& model, std::uint64_t seed);

/// Overlapping Gaussians with a temperature of any gradient, deviation and skewness.
Gaussians cloud_of_values();
/// Three colours over the range of a field, and a ramp with a gap.
ValueTransfer rainbow(const ScalarField& field);

/// Expects the same fields, bit for bit.
void expect_same_fields(const Fields& a, const Fields& b);

}  // namespace vog::test
