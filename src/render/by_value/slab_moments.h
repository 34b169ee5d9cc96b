// slab_moments.h: Moments of a field's values in a part of a ray, from sums over Gaussians, and their light.
//
// With phi the plane of a Gaussian in the middle of its part tau of the ray, r² and third the central moments of its
// residual, the sums are of  tau,  tau phi,  tau (phi² + r²),  tau (phi³ + 3 phi r² + third),  and tau g for light.
#pragma once

#include <cmath>

#include "render/by_value/light_of_moments.h"
#include "render/by_value/lighting.h"
#include "render/by_value/value_light.h"
#include "vog/linear.h"

namespace vog::by_value {

/// Central moments of shares of a field's range.
struct ValueMoments {
    double mean = 0, variance = 0, third = 0;
};

/// Two normal distributions with a mean, a variance and a skewness: with u = skewness / kShare³ they lie
/// kShare (u ± sqrt(u² + 4)) / 2 deviations from the mean, with weights (1 ∓ u / sqrt(u² + 4)) / 2, and have the variance
/// that is left. Narrow, so that the two can have most skewness; narrower ones miss what lies between.
struct NormalPair {
    static constexpr float kShare = 0.95f, kPerCube = 1 / (kShare * kShare * kShare),
                           kNarrow = 1 - kShare * kShare;
    /// Rounding of sums hides the third moment of less.
    static constexpr float kLeastVariance = 1e-5f;
    static constexpr float kMostSkewness = 3;

    double high, low;  ///< means
    double deviation;  ///< of both
    double of_high;    ///< weight
};
NormalPair normal_pair(const ValueMoments& moments);

/// Central moments of values about a Gaussian's plane.
struct Residual {
    double variance = 0, third = 0;
};
inline Residual residual_of(const ScalarField& field, const ValueRange& range, std::size_t i) {
    const double r = double{field.deviation[i]} / (range.upper - range.lower);
    return {r * r, double{field.skewness[i]} * r * r * r};
}
/// The same of a Gaussian drawn as a point: its plane spreads values, too.
/// within  variance_within(k)
inline Residual point_residual(const Gaussians& gaussians, const ScalarField& field,
                               const ValueRange& range, std::size_t i, double within) {
    const double extent = range.upper - range.lower;
    Residual residual = residual_of(field, range, i);
    residual.variance += within * plane_variance(gaussians, field, i) / (extent * extent);
    return residual;
}

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
    /// tau > 0
    ValueMoments moments() const {
        ValueMoments m;
        m.mean = first / tau;
        const double square = second / tau;
        m.variance = std::max(square - m.mean * m.mean, 0.0);
        m.third = third / tau - m.mean * (3 * square - 2 * m.mean * m.mean);
        return m;
    }
};

/// Light of parts of rays, one by one: the closed form of the loops over pixels.
class StepLight {
  public:
    /// throws  vog::Error as validate(transfer) does
    StepLight(const ValueTransfer& transfer, const ScalarField& field, const VolumeLook& look);
    /// Mean light per unit of tau, shaded.
    /// sums         tau > 0
    /// towards_eye  unit length
    std::array<float, 4> operator()(const MomentSums& sums, Vec3d towards_eye) const;

  private:
    LightOfMoments light_;
    Lighting lighting_;
};

}  // namespace vog::by_value
