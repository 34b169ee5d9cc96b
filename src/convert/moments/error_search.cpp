// error_search.cpp: false position on the logarithms of count and error.
#include "convert/moments/error_search.h"

#include <algorithm>
#include <cmath>

#include "vog/convert_moments.h"
#include "vog/distributed.h"

namespace vog::moments {

namespace {

constexpr double kSteepest = -1, kFlattest = -0.1;  // powers of the count that are believed

}  // namespace

std::size_t smallest_budget(double target, std::size_t finest_count,
                            const ErrorOfBudget& error_of_budget, double first) {
    constexpr double kTolerance = 1.05;
    constexpr int kTries = 12;
    const auto finest = static_cast<double>(std::max<std::size_t>(finest_count, 1));
    double count = std::clamp(first, 1.0, finest);
    // The budget lies in (low, high]: `low` misses the target, `high` meets it.
    double low = 1, high = finest, power = kErrorPower, last_count = 0, last_error = 0;
    double best = 0, best_error = -1;
    int same_side = 0;  // tries in a row that moved only `low`, or only `high` (negative)
    for (int tries = 0; (tries < kTries && high > low * kTolerance) || best_error < 0; ++tries) {
        const double measured = error_of_budget(static_cast<std::size_t>(count));
        const double error = std::max(measured, 1e-9);
        if (last_count > 0 && error != last_error) {
            const double secant = std::log(error / last_error) / std::log(count / last_count);
            power = std::clamp(std::isfinite(secant) ? secant : power, kSteepest, kFlattest);
        }
        last_count = count, last_error = error;
        if (error <= target || count >= finest) {
            high = best = count;
            best_error = measured;
            same_side = std::min(same_side, 0) - 1;
        } else {
            low = count;
            same_side = std::max(same_side, 0) + 1;
        }
        // Close enough: a tolerance fewer would miss the target.
        if (best_error >= target * std::pow(kTolerance, power)) break;
        // Aim at the middle of the tolerance.
        double guess = count * std::pow(target / error, 1 / power) * std::pow(kTolerance, 0.4);
        // Where the error is far from a power of the count one end stays where it is: bisect.
        if (best_error >= 0 && std::abs(same_side) > 2) guess = std::sqrt(low * high);
        count = std::clamp(guess, low * std::sqrt(kTolerance),
                           std::max(high / std::sqrt(kTolerance), low * std::sqrt(kTolerance)));
        if (best_error < 0 && (guess >= finest || tries >= kTries - 2)) count = finest;
    }
    return static_cast<std::size_t>(best);
}

}  // namespace vog::moments

namespace vog {

double error_beyond_interpolation(const RelativeError& error, const RelativeError& interpolation,
                                  double target, std::size_t finest) {
    if (finest <= kSmallCount) return error.worst;
    return target * std::max(error.worst / std::max(target, interpolation.worst),
                             error.mean / std::max(target, interpolation.mean));
}

std::size_t smallest_budget(double target, std::size_t finest,
                            const std::function<double(std::size_t)>& error_of_budget) {
    constexpr double kFirstShare = 0.01;
    return moments::smallest_budget(target, finest, error_of_budget,
                                    kFirstShare * static_cast<double>(finest));
}

}  // namespace vog
