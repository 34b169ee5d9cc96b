// color_spaces.h: colours between two control points, in the spaces ParaView interpolates in.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "vog/shade.h"

namespace vog::shading {

using Color = std::array<double, 3>;

/// kHsv turns the hue through the numbers between; kHsvWrapped takes the shorter way round.
enum class ColorSpace { kRgb, kHsv, kHsvWrapped, kLab, kDiverging };

/// The display colour at s in [0, 1] between two display colours, as VTK has it.
Color interpolate(ColorSpace space, const Color& from, const Color& to, double s);

/// A curve over s in [0, 1] as the fewest points, by bisection, whose straight lines keep within a
/// quarter of an 8-bit step of it. Returns (s, value) for s in (0, 1].
std::vector<std::pair<double, Color>> sample_curve(const std::function<Color(double)>& curve);

/// The transfer function through `control` (sorted by v) in `space`, made piecewise linear in RGB.
std::vector<ColorPoint> sample_colors(ColorSpace space, const std::vector<ColorPoint>& control);

}  // namespace vog::shading
