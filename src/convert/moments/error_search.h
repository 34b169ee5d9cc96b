// error_search.h: the smallest model whose measured error is low enough.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "vog/gaussians.h"

namespace vog::moments {

struct FoundModel {
    Gaussians model;
    double error = -1;
};

/// Where a search begins, and the power of the count that the error is near there.
struct SearchStart {
    double count = 0;  ///< 0: a hundredth of the finest
    double power = -0.35;
};
inline constexpr double kFirstShare = 0.01;

/// About the budget whose error is `target`, by three tries of an error that is cheap to tell.
template <class ErrorOf>
SearchStart search_start(double target, std::size_t finest_count, const ErrorOf& error_of) {
    constexpr double kCloseEnough = 0.15;
    constexpr int kTries = 3;
    const auto finest = static_cast<double>(finest_count);
    SearchStart start;
    start.count = std::max(1.0, kFirstShare * finest);
    double last_count = 0, last_error = 0;
    for (int tries = 0; tries < kTries; ++tries) {
        const double error = error_of(static_cast<std::size_t>(start.count));
        if (!(error > 0)) break;
        if (last_count > 0 && last_count != start.count) {
            const double power = std::log(error / last_error) / std::log(start.count / last_count);
            if (std::isfinite(power)) start.power = std::clamp(power, -1.0, -0.1);
        }
        last_count = start.count, last_error = error;
        start.count =
            std::clamp(start.count * std::pow(target / error, 1 / start.power), 1.0, finest);
        if (std::abs(error / target - 1) < kCloseEnough) break;
    }
    return start;
}

/// The smallest budget whose error is at most `target`, to 5 %: false position on the logarithms,
/// for which the error is close to a power of the count, kept inside what is known.
/// finest  the largest budget that makes a difference; its model is taken whatever its error
/// make    make(budget) returns a model and its measured error
template <class Make>
FoundModel smallest_model(double target, std::size_t finest_count, const Make& make,
                          const SearchStart& start = {}) {
    constexpr double kTolerance = 1.05;
    constexpr int kTries = 12;
    const auto finest = static_cast<double>(finest_count);
    double count = start.count > 0 ? start.count : std::max(1.0, kFirstShare * finest);
    double low = 1, high = finest, power = start.power, last_count = 0, last_error = 0;
    FoundModel best;
    int same_side = 0;  // tries in a row that moved only `low`, or only `high` (negative)
    for (int tries = 0; (tries < kTries && high > low * kTolerance) || best.error < 0; ++tries) {
        FoundModel found = make(static_cast<std::size_t>(count));
        const double error = std::max(found.error, 1e-9);
        if (last_count > 0 && error != last_error) {
            const double secant = std::log(error / last_error) / std::log(count / last_count);
            power = std::clamp(std::isfinite(secant) ? secant : power, -1.0, -0.1);
        }
        last_count = count, last_error = error;
        if (error <= target || count >= finest) {
            high = count;
            best = std::move(found);
            same_side = std::min(same_side, 0) - 1;
        } else {
            low = count;
            same_side = std::max(same_side, 0) + 1;
        }
        // Close enough: a tolerance fewer would miss the target.
        if (best.error >= target * std::pow(kTolerance, power)) break;
        // Aim at the middle of the tolerance.
        double guess = count * std::pow(target / error, 1 / power) * std::pow(kTolerance, 0.4);
        // Errors far from a power of the count leave one end where it is: then halve.
        if (best.error >= 0 && std::abs(same_side) > 2) guess = std::sqrt(low * high);
        count = std::clamp(guess, low * std::sqrt(kTolerance),
                           std::max(high / std::sqrt(kTolerance), low * std::sqrt(kTolerance)));
        if (best.error < 0 && (guess >= finest || tries >= kTries - 2)) count = finest;
    }
    return best;
}

}  // namespace vog::moments
