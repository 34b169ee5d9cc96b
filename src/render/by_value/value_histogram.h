// value_histogram.h: how much of a model has which value of a field.
#pragma once

#include <span>
#include <vector>

#include "vog/gaussians.h"

namespace vog::by_value {

/// Ends of bins over the range of a field's data, equal or of equal ratios; data of one value get a range around it.
/// logarithmic  for fields above 0 alone
/// returns      [bins + 1] ascending
std::vector<double> value_bins(const ScalarField& field, std::size_t bins,
                               bool logarithmic = false);
/// Measure of a model by a field's value, each Gaussian as a normal distribution.
/// field    of the model
/// edges    of the bins
/// returns  [bins] the largest 1; all 0 without measure
/// cost     O(N)
std::vector<float> value_histogram(const Gaussians& gaussians, const ScalarField& field,
                                   std::span<const double> edges);

}  // namespace vog::by_value
