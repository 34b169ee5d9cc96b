// budget_search.h: the smallest model whose measured error is low enough.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "vog/gaussians.h"

namespace vog {

struct FoundModel {
    Gaussians model;
    double error = -1;
};

/// The smallest budget whose error is at most `target`, to 4 %: false position on the logarithms,
/// for which the error is close to a power of the count, kept inside what is known.
/// finest  the largest budget that makes a difference; its model is taken whatever its error
/// make    make(budget) returns a model and its measured error
template <class Make>
FoundModel smallest_model(double target, std::size_t finest_count, const Make& make) {
    constexpr double kTolerance = 1.04, kFirstShare = 0.01, kUsualPower = -0.35;
    constexpr int kTries = 12;
    const auto finest = static_cast<double>(finest_count);
    double low = 1, high = finest, low_error = 0, count = std::max(1.0, kFirstShare * finest);
    FoundModel best;
    int same_side = 0;  // tries in a row that moved only `low`, or only `high` (negative)
    for (int tries = 0; (tries < kTries && high > low * kTolerance) || best.error < 0; ++tries) {
        FoundModel found = make(static_cast<std::size_t>(count));
        const double error = found.error;
        if (error <= target || count >= finest) {
            high = count;
            best = std::move(found);
            same_side = std::min(same_side, 0) - 1;
        } else {
            low = count;
            low_error = error;
            same_side = std::max(same_side, 0) + 1;
        }
        double power = kUsualPower;
        if (best.error > 0 && low_error > 0 && best.error < low_error && high > low)
            power = std::log(best.error / low_error) / std::log(high / low);
        // Aim a little beyond the target, so that the last try is a success.
        const double from = std::max(error <= target ? best.error : low_error, 1e-9);
        double guess = count * std::pow(0.995 * target / from, 1 / power);
        // Errors far from a power of the count leave one end where it is: then halve.
        if (best.error >= 0 && std::abs(same_side) > 1) guess = std::sqrt(low * high);
        count = std::clamp(guess, low * std::sqrt(kTolerance),
                           std::max(high / std::sqrt(kTolerance), low * std::sqrt(kTolerance)));
        if (best.error < 0 && (guess >= finest || tries >= kTries - 2)) count = finest;
    }
    return best;
}

}  // namespace vog
