// vog/field_maps.h: pictures of fields: column of the measure, and weighted mean and dispersion of a field along
// rays (docs/fields.md).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vog/fields.h"
#include "vog/quantity.h"

namespace vog {

/// Number shown of a field.
enum class FieldPart {
    value,  ///< a scalar field itself
    view,   ///< component of a vector field along the ray, away from the eye positive
    x,
    y,
    z,          ///< component of a vector field along a world axis
    magnitude,  ///< root mean square of a vector field (FieldMaps)
};

/// A field and the part of it that is shown.
struct FieldChoice {
    std::string field;
    FieldPart part = FieldPart::value;
    friend bool operator==(const FieldChoice&, const FieldChoice&) = default;
};

/// Reads "temperature", "velocity" (the component along the view), "velocity.x" or "velocity.magnitude".
/// throws  vog::Error listing the fields of the model, for an unknown field or part
FieldChoice field_choice(const std::string& text, const Fields& fields);
/// Name of the shown number: "temperature", "velocity along the view", "velocity.x", "rms of velocity".
std::string field_label(const FieldChoice& choice);

/// Sums along the ray through each pixel; rows from the top. The mean magnitude of a vector is not a sum of
/// moments; FieldPart::magnitude has, of the vector u and its mean <u> along the ray,
///   mean = sqrt <|u|^2>, the root mean square        deviation = sqrt <|u - <u>|^2>, in three dimensions
struct FieldMaps {
    int width = 0, height = 0;  ///< pixels
    std::vector<float>
        column;  ///< [height * width] integral of the measure, density times world units, >= 0
    std::vector<float>
        mean;  ///< [height * width] of the field weighted by the measure; NaN without column
    std::vector<float>
        deviation;  ///< [height * width] standard deviation, >= 0; NaN without column
};

/// Values that count for a color scale: where the column is at least a thousandth of the largest. Others are
/// the rims of supports, often of extreme values.
/// shown  [maps.column] the map that is shown
std::vector<float> values_for_scale(const FieldMaps& maps, std::span<const float> shown);
/// The shown map, NaN where the column is below a share of the largest.
ValueMap visible_values(const FieldMaps& maps, std::span<const float> shown, double least_share);

}  // namespace vog
