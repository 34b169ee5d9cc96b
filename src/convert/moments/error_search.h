// error_search.h: root finding on the error of a model as a function of its number of Gaussians.
#pragma once

#include <cstddef>
#include <functional>

namespace vog::moments {

/// Measured error of the model with at most `budget` Gaussians.
using ErrorOfBudget = std::function<double(std::size_t budget)>;

/// Power of the number of Gaussians that errors usually are proportional to.
inline constexpr double kErrorPower = -0.35;

/// vog::smallest_budget (vog/distributed.h) from a first guess.
std::size_t smallest_budget(double target, std::size_t finest, const ErrorOfBudget& error_of_budget,
                            double first);

}  // namespace vog::moments
