// ssim.h: structural similarity of two grey pictures.
// Source: Wang, Bovik, Sheikh, Simoncelli, "Image quality assessment: from error visibility to
// structural similarity", IEEE TIP 13(4), 2004, section III.
#pragma once

#include <vector>

namespace vog::comparison {

/// Mean SSIM over the windows that lie wholly inside the picture: 11x11 Gaussian of 1.5 pixels,
/// K1 = 0.01, K2 = 0.03. Values of 0 to 255. NaN where no window fits.
double structural_similarity(const std::vector<float>& reference, const std::vector<float>& image,
                             int width, int height);

}  // namespace vog::comparison
