// ticks.h: Ticks of a scale with their texts.
#pragma once

#include <string>
#include <vector>

#include "vog/quantity.h"

namespace vog::shading {

struct Tick {
    double value;
    std::string text;  ///< differs from those of the other ticks, however far they are from 0
};
/// scale_ticks with texts of six digits, or as many as the nearest other tick needs.
/// whole  at whole numbers alone
std::vector<Tick> ticks_of(const ColorScale& scale, double least_gap, bool whole = false);

/// Ticks of coordinates along an axis.
struct AxisTicks {
    std::vector<Tick> ticks;  ///< texts of the differences from the origin
    std::string origin;       ///< behind the axis's name: " - 1000000000"; empty: 0
};
/// Ticks from `low` to `high`. Numbers of more than six glyphs are those from a round origin where that makes them shorter.
AxisTicks axis_ticks(double low, double high, double least_gap);

/// annotated, of a colour bar whose ticks are at whole numbers alone, as of labels.
Image annotated_labels(const Image& picture, const TransferFunction& tf, const ColorScale& scale,
                       const Annotation& annotation, Rgba background);

}  // namespace vog::shading
