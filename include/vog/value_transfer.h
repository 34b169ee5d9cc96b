// vog/value_transfer.h: transfer functions of a field's values: colour and extinction, for volume rendering
// (docs/volume_rendering.md).
//   extinction = -ln(1 - opacity) / unit_distance
// with colour and opacity piecewise linear in the value between points, constant beyond the first and the last.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "vog/shade.h"

namespace vog {

/// Control point of colour.
struct ValueColor {
    double value = 0;           ///< value of the field, in its unit
    float r = 0, g = 0, b = 0;  ///< red, green, blue as displayed, [0, 1]
    friend bool operator==(const ValueColor&, const ValueColor&) = default;
};
/// Control point of opacity.
struct ValueOpacity {
    double value = 0;    ///< value of the field, in its unit
    double opacity = 0;  ///< share of light that is absorbed over unit_distance, [0, 1]
    friend bool operator==(const ValueOpacity&, const ValueOpacity&) = default;
};

/// Control point of gradient opacity.
struct GradientOpacity {
    double magnitude =
        0;              ///< length of the field's gradient, unit of the field per world unit, >= 0
    double factor = 1;  ///< multiplies the extinction, [0, 1]
    friend bool operator==(const GradientOpacity&, const GradientOpacity&) = default;
};
inline constexpr std::size_t kMostGradientPoints = 8;

/// Opacity above this counts as this: an opacity of 1 is an infinite extinction.
inline constexpr double kMostOpacity = 0.9999;

/// Transfer function from values to colour and extinction. Two points of one value make a step; at the value the
/// second one holds.
struct ValueTransfer {
    std::string name;                   ///< "inferno"; may be empty
    std::vector<ValueColor> color;      ///< at least one, sorted by value
    std::vector<ValueOpacity> opacity;  ///< at least one, sorted by value
    double unit_distance = 1;           ///< world units, > 0: length that an opacity refers to
    /// Factor of the extinction by the magnitude of the field's gradient there, linear between points, constant beyond them: 2 to
    /// kMostGradientPoints, ascending; none: 1 everywhere.
    std::vector<GradientOpacity> gradient{};
    friend bool operator==(const ValueTransfer&, const ValueTransfer&) = default;
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
/// throws  vog::Error as validate(transfer) does
void validate(const std::vector<GradientOpacity>& points);

/// Transfer function of values from one of shares of a range.
/// tf             points at shares of the range; without opacity: a ramp from 0 to 1
/// lower, upper   values of shares 0 and 1
/// unit_distance  world units
/// throws         vog::Error for an invalid tf, a range that is not finite and ascending, a unit distance <= 0
ValueTransfer over_range(const TransferFunction& tf, double lower, double upper,
                         double unit_distance);

/// Transfer function as a name or a file states it.
struct TransferPoints {
    ValueTransfer points;    ///< at shares of a range, [0, 1], or at values; opacity may be empty
    bool at_values = false;  ///< vog's JSON with "domain", ParaView's and VTK's
    double lower = 0, upper = 1;     ///< the file's range of values where at_values
    bool has_unit_distance = false;  ///< whether points.unit_distance is the file's
};
/// Points of a named map, or of a JSON file or a table of labels (docs/transfer_functions.md).
/// name_or_file  a name of transfer_function_names, or a path; of a table also with a label, "organs.ctbl:liver"
/// throws        vog::Error naming the file and the key
TransferPoints transfer_points(const std::string& name_or_file);
/// Transfer function of values from points, which are at shares of a range or at values.
/// lower, upper   values of shares 0 and 1; not used where points are at values
/// unit_distance  world units, where the points have none
/// log            shares of the range's logarithm, which is above 0, a ramp of their squares; not of points at values
/// throws         vog::Error as over_range does
ValueTransfer over_range(const TransferPoints& points, double lower, double upper,
                         double unit_distance, bool log = false);
/// Colours and opacities of shares as points. throws vog::Error for an invalid tf
TransferPoints transfer_points(const TransferFunction& tf);
/// Points at values, as a file of write_value_transfer states them. throws vog::Error as validate does
TransferPoints transfer_points(const ValueTransfer& transfer);
/// Both in one: the transfer function of values of a name or a file.
ValueTransfer read_value_transfer(const std::string& name_or_file, double lower, double upper,
                                  double default_unit_distance);

/// Writes a transfer function of values as vog's JSON with "domain" and "unit_distance", which --tf reads. Written
/// beside the file and renamed when whole.
/// throws  vog::Error as validate does, or if the file cannot be written
void write_value_transfer(const std::filesystem::path& file, const ValueTransfer& transfer);

/// Grey window of medical pictures: colour from black to white and opacity from 0 to kMostOpacity over
/// centre - width / 2 to centre + width / 2.
/// throws  vog::Error for a width that is not > 0, numbers that are not finite
ValueTransfer window_transfer(double center, double width, double unit_distance);

/// Band of values with one colour and opacity: lower <= value < upper.
struct ValueBand {
    double lower = 0, upper = 0;  ///< values of the field, in its unit; upper may be infinite
    float r = 0, g = 0, b = 0;    ///< colour as displayed, [0, 1]
    double opacity = 0;           ///< over unit_distance, [0, 1]
};
/// Transfer function of bands; nothing between them.
/// bands   in any order; bands may touch
/// throws  vog::Error for no band, bands that overlap or are inside out, and as validate does
ValueTransfer band_transfer(std::vector<ValueBand> bands, double unit_distance);

/// The same transfer function with nothing below a value.
/// throws  vog::Error for a threshold that is not finite
ValueTransfer above(ValueTransfer transfer, double threshold);
/// Largest opacity over a range of values.
/// throws  vog::Error as validate does, for a range that is not finite and lower <= upper
double most_opacity(const ValueTransfer& transfer, double lower, double upper);

}  // namespace vog
