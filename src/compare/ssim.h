// ssim.h: Structural similarity (SSIM) of two grey images.
// Source: Wang, Bovik, Sheikh, Simoncelli, "Image quality assessment: from error visibility to
// structural similarity", IEEE TIP 13(4), 2004, section III.
#pragma once

#include <vector>

namespace vog::comparison {

/// Mean SSIM over the windows that lie wholly inside the image: 11x11 pixels, weighted by a Gaussian
/// of standard deviation 1.5 pixels; K1 = 0.01, K2 = 0.03.
/// reference, image  [height * width] values of 0 to 255
/// returns           [-1, 1]; NaN if the image is smaller than a window
double structural_similarity(const std::vector<float>& reference, const std::vector<float>& image,
                             int width, int height);

}  // namespace vog::comparison
