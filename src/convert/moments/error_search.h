// error_search.h: root finding on the error of a model as a function of its number of Gaussians.
#pragma once

#include <cstddef>
#include <functional>

namespace vog::moments {

/// Measured error of the model with at most `budget` Gaussians.
using ErrorOfBudget = std::function<double(std::size_t budget)>;

/// First guess of a search: near `count` the error is proportional to count^power.
struct SearchStart {
    double count = 0;  ///< 0: a hundredth of the finest cut
    double power = -0.35;
};

/// Estimates the budget whose error is `target` from three evaluations of a cheap error.
/// finest  Gaussians of the finest cut
SearchStart search_start(double target, std::size_t finest, const ErrorOfBudget& error_of_budget);

/// vog::smallest_budget (vog/distributed.h) from this start.
std::size_t smallest_budget(double target, std::size_t finest, const ErrorOfBudget& error_of_budget,
                            const SearchStart& start);

}  // namespace vog::moments
