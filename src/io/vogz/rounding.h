// rounding.h: lattices on which the numbers of a model are rounded, the same for all chunks of a file.
#pragma once

#include <algorithm>
#include <vector>

#include "vog/gaussians.h"
#include "vog/vogz.h"

namespace vog::vogz {

/// Lattices of means, shapes and masses.
struct ShapeRounding {
    /// Corner and edge of the cube of all means, relative to the model's origin. A mean is the centre of a cell of
    /// edge * 2^exponent, from the corner.
    Vec3d corner;
    double edge = 1;
    /// Exponent of a Gaussian's cells: floor(at_zero + per_trace * t), t the sum of the diagonal words of its shape.
    double exponent_at_zero = 0, exponent_per_trace = 0;
    double diagonal_step = 0, shear_step = 0;  ///< of the entries of LogShape
    double mass_step = 0;                      ///< of ln(density * s0 * s1 * s2)

    int exponent(double trace) const {
        constexpr double kMost = 1000;
        const double number =
            std::clamp(exponent_at_zero + exponent_per_trace * trace, -kMost, kMost);
        const int toward_zero = static_cast<int>(number);
        return toward_zero - (number < toward_zero ? 1 : 0);
    }
};
/// model   with a Gaussian at least
/// step    VogzPrecision::step
ShapeRounding shape_rounding(const Gaussians& model, double step);

/// Lattice of a field's numbers.
struct FieldRounding {
    double reference = 0;  ///< value of word 0, in the field's unit
    double unit = 1;       ///< of value, change over a standard deviation, and deviation
    double step = 0;       ///< of values, in units
};
/// step  VogzPrecision::field_step
FieldRounding field_rounding(const ScalarField& field, double step);
FieldRounding field_rounding(const VectorField& field, double step);

/// Steps of a field's other numbers, from that of values: a gradient matters less at distances below a standard deviation,
/// square roots of deviations have an error proportional to themselves, and skewness and correlations change profiles only.
inline constexpr double kChangeSteps = 1.41, kDeviationSteps = 4, kShareSteps = 32;

}  // namespace vog::vogz
