// slab_moments.cpp: Moments of sums in double precision, and the limit of maxima.
#include "render/by_value/slab_moments.h"

#include <algorithm>
#include <cmath>

#include "data/fields/field_limits.h"

namespace vog::by_value {

Residual point_residual(const Gaussians& gaussians, const ScalarField& field,
                        const ValueRange& range, std::size_t i, double within) {
    const double extent = range.upper - range.lower;
    Residual residual = residual_of(field, range, i);
    residual.variance += within * plane_variance(gaussians, field, i) / (extent * extent);
    return residual;
}

device::ValueMoments MomentSums::moments() const {
    if (!(tau > 0)) return {0, 0, 0, 0, {0, 0, 0}};
    const auto f = [](double v) { return static_cast<float>(v); };
    const double mean = first / tau, square = second / tau;
    return {f(tau),
            f(mean),
            f(std::max(square - mean * mean, 0.0)),
            f(third / tau - mean * (3 * square - 2 * mean * mean)),
            {f(gradient.x / tau), f(gradient.y / tau), f(gradient.z / tau)}};
}

double most_share_per_density(const ScalarField& field) {
    // Smoke of 2,990 Gaussians lies 34.4 dB from its voxels with 3 and with 5, 33.8 with 1.2, 33.0 without limit.
    constexpr double kMost = 3;
    const double range = field.upper - field.lower;
    return field.is_measure && range > 0 ? kMost / range : HUGE_VAL;
}

}  // namespace vog::by_value
