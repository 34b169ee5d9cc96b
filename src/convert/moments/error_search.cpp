// error_search.cpp: false position on the logarithms of count and error.
#include "convert/moments/error_search.h"

#include <algorithm>
#include <cmath>

#include "vog/budget_search.h"
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

namespace {

constexpr double kFirstShare = 0.01;  // of the finest count: the first one tried

}  // namespace

double error_beyond_interpolation(const RelativeError& error, const RelativeError& interpolation,
                                  double target, std::size_t finest) {
    if (finest <= kSmallCount) return error.worst;
    return target * std::max(error.worst / std::max(target, interpolation.worst),
                             error.mean / std::max(target, interpolation.mean));
}

std::size_t smallest_budget(double target, std::size_t finest,
                            const std::function<double(std::size_t)>& error_of_budget) {
    return moments::smallest_budget(target, finest, error_of_budget,
                                    kFirstShare * static_cast<double>(finest));
}

RelativeError find_budget(const ErrorSearch& search, RelativeError& interpolation) {
    // A Gaussian a voxel interpolates the voxels too, pictures have its mean over a pixel where voxels are smaller, and no cut
    // comes nearer. Measuring it takes less time than a try of more Gaussians than default_count. Sixteen times as many
    // Gaussians usually have 16^-0.35 = 0.38 of an error. Where they gain less than an eighth, voxels limit it.
    constexpr double kAsNear = 1.125;
    std::size_t most = search.few;
    RelativeError best;
    const auto beyond = [&](const RelativeError& error) {
        return error_beyond_interpolation(error, interpolation, search.target, search.finest);
    };
    const auto error_of_budget = [&](std::size_t budget) {
        const RelativeError error = search.error_of_budget(budget);
        if (beyond(error) <= search.target || budget >= most) best = error, search.keep();
        return beyond(error);
    };
    const auto few = static_cast<double>(most);
    moments::smallest_budget(search.target, most, error_of_budget,
                             search.first > 0 ? search.first : kFirstShare * few);
    if (!search.beyond_few || most >= search.finest || beyond(best) <= search.target) return best;
    const RelativeError voxels = search.error_of_voxels();
    interpolation = {std::max(interpolation.worst, kAsNear * voxels.worst),
                     std::max(interpolation.mean, kAsNear * voxels.mean)};
    if (beyond(best) <= search.target) return best;
    most = search.finest;
    moments::smallest_budget(search.target, most, error_of_budget, 2 * few);
    return best;
}

}  // namespace vog
