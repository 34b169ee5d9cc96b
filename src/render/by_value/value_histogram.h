// value_histogram.h: how much of a model has which value of a field.
#pragma once

#include <vector>

#include "vog/gaussians.h"

namespace vog::by_value {

/// Measure of a model by a field's value, each Gaussian as a normal distribution: equal bins over the data's range
/// (web_unit's where all values are one), the largest 1; all 0 without measure.
/// field  of the model
/// cost   O(N)
std::vector<float> value_histogram(const Gaussians& gaussians, const ScalarField& field,
                                   std::size_t bins);

}  // namespace vog::by_value
