// pixel_limits.h: Screen sizes below which a Gaussian is drawn as its mean over pixels
// (docs/method.md, "Gaussians smaller than a pixel"). Shared by every splatting renderer.
//
// Both limits are standard deviations of the truncated kernel on the screen, which are
// sqrt(variance_within(k)) of its scale, so that they hold for any cutoff.
#pragma once

namespace vog::device {

/// Smallest standard deviation that is drawn, pixels. A thinner Gaussian is widened to it at
/// constant mass. The support's radius is then 1.1 pixels at least (sqrt(5) times it, the ball that
/// small cutoffs tend to), more than the 0.71 from a pixel's corner to its centre: some centre is
/// always inside.
constexpr double kLeastDeviationPx = 0.5;

/// The same in pictures whose rays are shifted, of which the mean is drawn, pixels. With the pixel's
/// own 0.29 it adds up to 0.35; the support covers half a pixel's area, so that no Gaussian is missed
/// for more than a few pictures.
constexpr double kSubframeDeviationPx = 0.2;

/// Standard deviation from which rays through pixel centres are exact, pixels: their sum over a
/// lattice differs from the integral by at most 0.5 % at k = 2.25 and 0.05 % at 3.03, wherever the
/// mean. The edge of the truncated kernel makes the difference 1.9 % at 0.9 pixels. Below, a
/// Gaussian is divided by its sum over the lattice; from kTaperFromPx on by less and less, so that
/// pictures change continuously with the camera.
constexpr double kSampledDeviationPx = 2.0, kTaperFromPx = 1.75;

/// Half extents of a support, pixels, from which the division ends: all of it up to the first, none
/// from the second. A longer support is a needle's, whose sum its length averages.
constexpr double kTaperHalfPx = 5.0, kMostHalfPx = 6.0;

/// The same for the half depth of a support over its distance along the view. The integral over the
/// screen has the mean of 1/z² as a factor, (1 + 3 var(z)/z²) / z² to 1e-4 up to here.
constexpr double kTaperHalfDepth = 0.1, kMostHalfDepth = 0.2;

}  // namespace vog::device
