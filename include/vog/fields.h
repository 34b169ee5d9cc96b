// vog/fields.h: fields, quantities that Gaussians know beside their density: temperature, velocity, the value
// of a scan itself (docs/fields.md).
//
// Inside Gaussian i a scalar field is a plane with a residual:
//   phi_i(x) = value_i + gradient_i . (x - mean_i), plus a residual of standard deviation deviation_i and
//   skewness skewness_i
// by the moments of position and value over the part of the data that is the Gaussian's: the joint distribution,
// weighted by the measure (density, unless the conversion states another).
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "vog/linear.h"
#include "vog/memory.h"

namespace vog {

/// Percentiles of a field's values over the data, weighted by the measure, to three digits: ranges that a few voxels do not stretch.
struct ValueSpread {
    double low = 0, middle = 0, high = 0;  ///< 1st, 50th and 99th percentile, in the unit
    bool known = false;
    friend bool operator==(const ValueSpread&, const ValueSpread&) = default;
};

/// Scalar field on N Gaussians.
struct ScalarField {
    std::string name;             ///< "temperature"
    std::string unit;             ///< "K"; empty: not known
    double lower = 0, upper = 0;  ///< least and largest value of the data, in the unit
    /// Whether the field is the measure itself, the density of the data: its extinction by value is not weighed by
    /// density once more (vog/volume_picture.h).
    bool is_measure = false;
    ValueSpread
        spread{};  ///< percentiles of the data; unknown: value_data (vog/picture.h) has those of the Gaussians

    BigVector<float> value;      ///< [N] at the Gaussian's mean, in the unit
    BigVector<Vec3f> gradient;   ///< [N] unit per world unit
    BigVector<float> deviation;  ///< [N] standard deviation of the residual, in the unit, >= 0
    BigVector<float> skewness;   ///< [N] third standardised moment of the residual, [-3, 3]

    /// Value at which the density of a measure is 0, in the unit: density is the value above it.
    double background = 0;
};

/// Vector field on N Gaussians, components along the world's axes.
struct VectorField {
    std::string name;             ///< "velocity"
    std::string unit;             ///< "m/s"; empty: not known
    double lower = 0, upper = 0;  ///< least and largest magnitude of the data, in the unit

    BigVector<Vec3f> value;  ///< [N] at the Gaussian's mean, in the unit
    /// [3][N] gradient of each component, unit per world unit.
    std::array<BigVector<Vec3f>, 3> gradient;
    /// [N] covariance of the residual, xx xy xz yy yz zz, in the unit squared: along a direction d
    /// its variance is d^T R d.
    BigVector<std::array<float, 6>> covariance;
};

/// Fields of a model: names differ from each other.
struct Fields {
    std::vector<ScalarField> scalar;
    std::vector<VectorField> vector;

    bool empty() const { return scalar.empty() && vector.empty(); }
    /// The field of this name; null: none.
    const ScalarField* find_scalar(const std::string& name) const;
    const VectorField* find_vector(const std::string& name) const;
    /// Names of all fields, scalar ones first.
    std::vector<std::string> names() const;
};

/// Appends the fields of `other`, models of n and m Gaussians; both have the same fields, in any order.
/// Ranges are united; spreads that differ are unknown then. A model without Gaussians takes the other's fields.
/// throws  vog::Error naming a field that one of them lacks, or whose unit differs
void append(Fields& fields, std::size_t n, const Fields& other, std::size_t m);

}  // namespace vog
