// pixel_limits.h: Limits of the Gaussians that are drawn as their mean over pixels, for one cutoff
// (docs/method.md, "Gaussians smaller than a pixel").
#pragma once

namespace vog {

/// Variances are squares of Gaussians::scale on the screen, pixels².
struct PixelLimits {
    double least2 = 0;    ///< smallest variance drawn; 0: Gaussians of any size are sampled
    double sampled2 = 0;  ///< variance from which pixel centres are exact
    double variance = 1;  ///< variance_within(cutoff)
    double mass = 0;      ///< of a Gaussian of peak 1 and standard deviations 1
};
/// cutoff  k, (0, 8]
PixelLimits pixel_limits(double cutoff);
/// Of a picture whose rays are shifted from the centres of pixels, one of several whose mean is
/// drawn: the mean over the shifts does what pixel_limits() does for a single picture.
PixelLimits subframe_limits(double cutoff);

}  // namespace vog
