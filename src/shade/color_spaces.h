// color_spaces.h: interpolation between control colours in ParaView's colour spaces.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "vog/shade.h"

namespace vog::shading {

/// Red, green, blue of the display, or coordinates of another space.
using Color = std::array<double, 3>;

/// kHsv interpolates the hue as a number; kHsvWrapped along the shorter arc.
enum class ColorSpace { kRgb, kHsv, kHsvWrapped, kLab, kDiverging };

/// Display colour at s in [0, 1] between two display colours, as VTK interpolates.
Color interpolate(ColorSpace space, const Color& from, const Color& to, double s);

/// Samples of a curve over s in [0, 1], by bisection; linear interpolation is within 0.25 / 255.
/// returns  (s, value) for s in (0, 1], ascending
std::vector<std::pair<double, Color>> sample_curve(const std::function<Color(double)>& curve);

/// Piecewise linear RGB approximation of the interpolation of `control` in `space`.
/// control  sorted by v
std::vector<ColorPoint> sample_colors(ColorSpace space, const std::vector<ColorPoint>& control);

}  // namespace vog::shading
