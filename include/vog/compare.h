// vog/compare.h: how far one picture is from another. The first is always the reference.
// Figures of pictures are of 8-bit values, round(255 c), as a viewer shows them; figures of T are
// of the floats. What each figure means, with its formula: docs/evaluation.md, "Figures".
#pragma once

#include "vog/image.h"
#include "vog/shade.h"

namespace vog {

/// Two pictures, 8 bits a channel.
struct PictureDifference {
    double psnr_db = 0;  ///< 10 log10(255² / mean squared difference); infinity: no value differs
    double ssim = 0;     ///< of the grey (luma) values, 1: equal; NaN below 11 pixels a side
    double share_off_1 = 0;  ///< share of pixels with a channel off by more than 1 of 255, [0, 1]
    double share_off_4 = 0;  ///< ... by more than 4 of 255
    int largest = 0;         ///< largest difference of a channel, of 255
    int largest_column = 0, largest_row = 0;  ///< where; the first such pixel
};

/// Colours over black where they are transparent; the channels weigh the same in the PSNR.
/// throws vog::Error if the sizes differ
[[nodiscard]] PictureDifference compare(const Image& reference, const Image& image);

/// Two depth images, both taken at the extinction of the reference.
struct DepthDifference {
    PictureDifference grey;  ///< of V = 1 - exp(-T) as a grey picture
    double relative_l2 = 0;  ///< |T - T_ref|₂ / |T_ref|₂
    double bias = 1;         ///< mean T / mean T_ref
    double largest_dt = 0;   ///< T - T_ref where it is largest in magnitude, signed
    int largest_column = 0, largest_row = 0;  ///< where; the first such pixel
    double extinction = 1;                    ///< the reference's: what T and V above are at
    bool identical = false;                   ///< every T is the same
};

/// relative_l2 and bias are 0 and 1 where both images are empty; infinite where the reference is.
/// throws vog::Error if the sizes differ
[[nodiscard]] DepthDifference compare(const DepthImage& reference, const DepthImage& image);

/// Both shaded with the same transfer function on black, at the reference's extinction.
[[nodiscard]] PictureDifference compare_shaded(const DepthImage& reference, const DepthImage& image,
                                               const TransferFunction& tf);

struct DifferenceMapOptions {
    /// End of the colour scale, in 1/255. 0: the largest difference, rounded up to 1, 2 or 5 times
    /// a power of ten.
    double limit = 0;
    bool bar = true;  ///< add the colour scale, with figures, on the right
};

/// Heat map of V - V_ref: blue where too little is seen, red where too much, grey where equal.
[[nodiscard]] Image difference_map(const DepthImage& reference, const DepthImage& image,
                                   const DifferenceMapOptions& options = {});
/// Heat map of the largest difference of the three channels, black where equal.
[[nodiscard]] Image difference_map(const Image& reference, const Image& image,
                                   const DifferenceMapOptions& options = {});

}  // namespace vog
