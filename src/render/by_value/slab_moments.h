// slab_moments.h: A field's values in Gaussians, and sums of their moments over parts of a ray (device/value_moments.h).
#pragma once

#include "render/by_value/light_of_moments.h"
#include "render/device/value_moments.h"
#include "vog/gaussians.h"
#include "vog/linear.h"

namespace vog::by_value {

/// Central moments of values about a Gaussian's plane.
struct Residual {
    double variance = 0, third = 0;
};
inline Residual residual_of(const ScalarField& field, const ValueRange& range, std::size_t i) {
    const double r = double{field.deviation[i]} / (range.upper - range.lower);
    return {r * r, double{field.skewness[i]} * r * r * r};
}
/// The residual of a Gaussian drawn as a point: its plane spreads values, too.
/// within  variance_within(k)
Residual point_residual(const Gaussians& gaussians, const ScalarField& field,
                        const ValueRange& range, std::size_t i, double within);

/// Sums over a part of a ray.
struct MomentSums {
    double tau = 0, first = 0, second = 0, third = 0;
    Vec3d gradient{};  ///< tau times the gradient of the share

    /// within  central moments about the plane
    void add(double part, double share, const Residual& within) {
        tau += part;
        first += part * share;
        second += part * (share * share + within.variance);
        third += part * (share * (share * share + 3 * within.variance) + within.third);
    }
    device::ValueMoments moments() const;
};

/// Largest share of the field's range per density where the field is the density itself; else infinite. The mean of
/// density weighted by itself exceeds the density at a point, but not by far: tails of Gaussians beyond the data do
/// not show the values within.
double most_share_per_density(const ScalarField& field);
/// Value of a share of the field's range.
inline float value_of_share(const ScalarField& field, double share) {
    return static_cast<float>(field.lower + share * (field.upper - field.lower));
}

}  // namespace vog::by_value
