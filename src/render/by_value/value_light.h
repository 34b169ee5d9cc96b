// value_light.h: Expected light of each Gaussian by value (docs/volume_rendering.md): what a transfer function
// gives over the distribution of a field's values in a Gaussian.
//
// At a point where the field's plane has the value phi, the values are distributed about phi with the residual's
// deviation r and skewness q: two narrow normal distributions that have these moments,
//   phi + r c z±,  z± = (u ± sqrt(u² + 4)) / 2,  u = q / c³,  weights ∓z∓ / (z+ - z-),  deviation r sqrt(1 - c²)
// The expectation over each comes from a table, made anew for a transfer function. Over a Gaussian's own range of
// phi it is smooth: one quadratic a channel in place of a table in the loops over pixels.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "render/by_value/lighting.h"
#include "vog/gaussians.h"
#include "vog/value_transfer.h"

namespace vog::by_value {

/// Light per unit of the measure and world unit: extinction times red, green and blue, and extinction.
using Light = std::array<float, 4>;

/// Light of a Gaussian, each channel c[0] + c[1] z + c[2] z² with z = (phi - value) / spread.
struct LightQuadratic {
    std::array<std::array<float, 3>, 4> c{};
    /// Standard deviation of the plane over the Gaussian without its truncation; 0: constant.
    float spread = 0;

    /// Light at z, no channel below 0.
    Light at(float z) const {
        Light light;
        for (std::size_t n = 0; n < 4; ++n) {
            const float sum = (c[n][2] * z + c[n][1]) * z + c[n][0];
            light[n] = sum > 0 ? sum : 0;
        }
        return light;
    }
};

/// A quadratic with its colours shaded (render/lighting.h), as far as the plane explains the values.
/// share  of its spread that counts: the plane's variance over that and the residual's, [0, 1]
inline LightQuadratic shaded(LightQuadratic light, const Shading& by, double share) {
    const auto body = static_cast<float>(1 + share * (by.body - 1));
    const auto shine = static_cast<float>(share * by.shine);
    for (std::size_t n = 0; n < 3; ++n)
        for (std::size_t power = 0; power < 3; ++power)
            light.c[n][power] = body * light.c[n][power] + shine * light.c[3][power];
    return light;
}
/// Share of the values' variance that the plane explains in a Gaussian, [0, 1].
/// within  variance_within(k)
inline double explained_share(const LightQuadratic& light, double deviation, double within) {
    const double plane = within * double{light.spread} * double{light.spread};
    return plane > 0 ? plane / (plane + deviation * deviation) : 0;
}

/// Variance of the field's plane over Gaussian i of the model, without its truncation.
double plane_variance(const Gaussians& gaussians, const ScalarField& field, std::size_t i);

/// Means of light under normal distributions, for renderers that look them up themselves.
struct LightTable {
    std::span<const Light> light;  ///< [rows][columns]
    int rows = 0,
        columns = 0;  ///< of deviations: (row / (rows - 1))^3 of half the range; of mean values
    double lower = 0, upper = 0;  ///< the data's range, widened where all values are one
    double low = 0,
           high = 0;  ///< part of the range with half of the columns, the other half over all of it
};

/// Expected light of values under normal distributions cut at the ends of the data's range.
class ExpectedLight {
  public:
    /// lower, upper  range of the data
    /// per_value     light per unit of the value: of a field that is the measure itself
    ExpectedLight(const ValueTransfer& transfer, double lower, double upper, bool per_value);
    /// Two normal distributions that have a deviation, >= 0, and a skewness about any mean.
    class Pair {
      public:
        std::array<float, 4> at(double mean) const;

      private:
        friend class ExpectedLight;
        Pair(const ExpectedLight& expected, double deviation, double skewness);
        const ExpectedLight& expected_;
        double offset_[2], weight_[2];
        const Light* row_;  ///< of the table, and how much of the next one counts
        float down_;
    };
    Pair pair(double deviation, double skewness) const { return {*this, deviation, skewness}; }
    /// Valid while this lives.
    LightTable table() const;

  private:
    /// Position of a value in the table's columns: half of them over the data's range, half over the part of it
    /// where the transfer function changes.
    double position(double value) const;
    double value_at(double position) const;

    double lower_, upper_, low_, high_, most_deviation_;
    double per_range_, per_part_;  ///< half of 1 / (upper - lower), and of 1 / (high - low)
    std::vector<Light> table_;     ///< [deviation][value]
};

/// Fits the quadratics of all Gaussians.
/// field   a scalar field of the model
/// throws  vog::Error for an invalid transfer function
std::vector<LightQuadratic> fit_light(const Gaussians& gaussians, const ScalarField& field,
                                      const ValueTransfer& transfer);

/// Planes of a field in place of light: channel 0 the value's share of the field's range, channel 3 is 1. Sums over
/// Gaussians are then of densities, and of densities times values.
std::vector<LightQuadratic> value_planes(const Gaussians& gaussians, const ScalarField& field);
/// Largest share of the field's range per density where the field is the density itself; else infinite. The mean of
/// density weighted by itself exceeds the density at a point, but not by far: tails of Gaussians beyond the data do
/// not show the values within.
double most_share_per_density(const ScalarField& field);
/// Value of a share of the field's range.
inline float value_of_share(const ScalarField& field, double share) {
    return static_cast<float>(field.lower + share * (field.upper - field.lower));
}

}  // namespace vog::by_value
