// splat_density.h: densities of Gaussians that other programs store as opacities.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vog/linear.h"

namespace vog::exchange {

/// Where renderers of splats cut off the kernel, in standard deviations.
inline constexpr float kSplatCutoff = 3;

/// Largest density of a Gaussian of which a ray through the mean, along the mean direction, sees an opacity:
/// -ln(1 - opacity) / (sqrt(2 pi) s), s the geometric mean of the standard deviations.
/// opacity  [0, 1]; above 0.9999 as that
inline float splat_density(double opacity, Vec3f scale) {
    constexpr double kMost = 0.9999;
    const double spread = std::cbrt(double{scale.x} * scale.y * scale.z);
    return static_cast<float>(-std::log1p(-std::min(opacity, kMost)) /
                              (std::sqrt(2 * std::numbers::pi) * spread));
}

}  // namespace vog::exchange
