// field_models.h: models with fields.
#pragma once

#include <cstdint>

#include "vog/gaussians.h"

namespace vog::test {

/// Gives a model the scalar fields "temperature" and "density", a name of its own properties, and the vector field
/// "gas velocity", all random; with units and ranges that have no short decimal form.
void add_random_fields(Gaussians& model, std::uint64_t seed);

/// Expects the same fields, bit for bit.
void expect_same_fields(const Fields& a, const Fields& b);

}  // namespace vog::test
