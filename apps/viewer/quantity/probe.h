// probe.h: numbers of one pixel in words, and the value where a ray becomes opaque.
#pragma once

#include <optional>
#include <string>

#include "quantity/quantity.h"
#include "vog/gaussians.h"

namespace vog::viewer {

/// Place on a ray where half of the light of what is behind is absorbed.
struct OpaqueValue {
    double value = 0;     ///< of the field, weighted by the measure at that point, in its unit
    double distance = 0;  ///< from the origin, world units
};
/// The first place on a ray where the transmittance is a half, in steps of a quarter of the thinnest Gaussian met there;
/// nothing: the ray stays clearer than that.
/// field      a scalar field of the model
/// direction  of any length > 0
/// cost       O(Gaussians) and the steps
std::optional<OpaqueValue> first_opaque_value(const Gaussians& gaussians, const ScalarField& field,
                                              const ValueTransfer& transfer, const Clipping& clip,
                                              Vec3d origin, Vec3d direction);

/// "T 1.23, V 0.708", "column 0.31", "mean of temperature 1240 K, column 0.31"; empty: nothing is there.
/// numbers     of the picture, and the place of the pixel in them
/// most        largest column of the picture
/// extinction  factor on density in T
std::string probe_text(const Quantity& quantity, const Fields& fields, const Sums& numbers,
                       std::size_t pixel, float most, double extinction);
/// "density 0.42 at distance 12.3", or that the ray is clear.
std::string opaque_text(const Quantity& quantity, const Fields& fields,
                        const std::optional<OpaqueValue>& found);
}  // namespace vog::viewer
