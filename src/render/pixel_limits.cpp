// pixel_limits.cpp: The limits of render/device/pixel_limits.h, in terms of a model's scales.
#include "render/pixel_limits.h"

#include <cmath>
#include <numbers>

#include "render/device/pixel_limits.h"
#include "vog/gaussians.h"

namespace vog {

PixelLimits pixel_limits(double cutoff) {
    PixelLimits limits;
    // At small cutoffs the terms of the closed forms cancel; the kernel is a ball there, to k²/7.
    constexpr double kBall = 0.03;
    const double k = cutoff;
    const bool ball = k < kBall;
    const double share = ball ? std::sqrt(2 / std::numbers::pi) * k * k * k / 3 : mass_within(k);
    limits.variance = ball ? k * k / 5 : variance_within(k);
    limits.least2 = device::kLeastDeviationPx * device::kLeastDeviationPx / limits.variance;
    limits.sampled2 = device::kSampledDeviationPx * device::kSampledDeviationPx / limits.variance;
    limits.mass = std::pow(2 * std::numbers::pi, 1.5) * share;
    return limits;
}

PixelLimits subframe_limits(double cutoff) {
    PixelLimits limits = pixel_limits(cutoff);
    const double less = device::kSubframeDeviationPx / device::kLeastDeviationPx;
    limits.least2 *= less * less;
    limits.sampled2 = 0;
    return limits;
}

}  // namespace vog
