// vog/value_transfer.h: transfer functions of a field's values: colour and extinction, for volume rendering by value
// (docs/volume_rendering.md).
//   extinction = -ln(1 - opacity) / unit_distance
// with colour and opacity piecewise linear in the value between points, constant beyond the first and the last.
#pragma once

#include <string>
#include <vector>

#include "vog/shade.h"

namespace vog {

/// Control point of colour.
struct ValueColor {
    double value = 0;           ///< of the field, in its unit
    float r = 0, g = 0, b = 0;  ///< red, green, blue as displayed, [0, 1]
};
/// Control point of opacity.
struct ValueOpacity {
    double value = 0;    ///< of the field, in its unit
    double opacity = 0;  ///< share of light that is absorbed over unit_distance, [0, 1]
};

/// Opacity above this counts as this: an opacity of 1 is an infinite extinction.
inline constexpr double kMostOpacity = 0.9999;

/// Transfer function from values to colour and extinction. Two points of one value make a step; at the value the
/// second one holds.
struct ValueTransfer {
    std::string name;                   ///< "inferno"; may be empty
    std::vector<ValueColor> color;      ///< at least one, sorted by value
    std::vector<ValueOpacity> opacity;  ///< at least one, sorted by value
    double unit_distance = 1;           ///< world units, > 0: length that an opacity refers to
};

/// Light of a value.
struct ValueLight {
    double extinction = 0;       ///< per world unit
    double r = 0, g = 0, b = 0;  ///< colour as displayed, [0, 1]
};

/// Colour and extinction of one value.
/// value   finite
/// throws  vog::Error as validate does
ValueLight light_of(const ValueTransfer& transfer, double value);

/// throws  vog::Error for no points, points out of order, numbers that are not finite or out of range
void validate(const ValueTransfer& transfer);

/// Transfer function of values from one of shares of a range.
/// tf             points at shares of the range; without opacity: a ramp from 0 to 1
/// lower, upper   values of shares 0 and 1
/// unit_distance  world units
/// throws         vog::Error for an invalid tf, a range that is not finite and ascending, a unit distance <= 0
ValueTransfer over_range(const TransferFunction& tf, double lower, double upper,
                         double unit_distance);

}  // namespace vog
