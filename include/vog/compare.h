// vog/compare.h: differences between two pictures or two depth images, as numbers and as heat maps.
// The first argument is always the reference. Pictures are compared by their 8-bit values,
// round(255 c), as displayed; T, the optical depth, by its floats. Definitions: docs/evaluation.md,
// "Figures".
#pragma once

#include "vog/image.h"
#include "vog/shade.h"

namespace vog {

/// Difference of two pictures with 8 bits a channel.
struct PictureDifference {
    /// Peak signal-to-noise ratio, dB: 10 log10(255² / mean squared difference over all pixels and
    /// channels). Infinity: no value differs.
    double psnr_db = 0;
    /// Mean structural similarity of the luma, [-1, 1], 1: equal; NaN below 11 pixels a side.
    /// Source: Wang et al. 2004, windows of 11x11 pixels.
    double ssim = 0;
    double share_off_1 = 0;  ///< share of pixels with a channel off by more than 1 of 255, [0, 1]
    double share_off_4 = 0;  ///< share of pixels with a channel off by more than 4 of 255, [0, 1]
    int largest = 0;         ///< largest absolute difference of a channel, [0, 255]
    /// Pixel with the largest difference, from the top left, counted from 0; the first of several.
    int largest_column = 0, largest_row = 0;
};

/// Compares two colour images, transparent ones over black. In the PSNR the three channels weigh
/// the same.
/// throws  vog::Error if the sizes differ, or an image has no pixels or NaN
[[nodiscard]] PictureDifference compare(const Image& reference, const Image& image);

/// Difference of two depth images at the extinction of the reference.
struct DepthDifference {
    PictureDifference grey;  ///< difference of V = 1 - exp(-T) as 8-bit grey, round(255 V)
    double relative_l2 = 0;  ///< |T - T_ref|₂ / |T_ref|₂ over all pixels, >= 0
    double bias = 1;         ///< mean T / mean T_ref, >= 0; below 1: too little optical depth
    double largest_dt = 0;   ///< T - T_ref of largest magnitude, with its sign
    /// Pixel of largest_dt, from the top left, counted from 0; the first of several.
    int largest_column = 0, largest_row = 0;
    double extinction = 1;   ///< extinction of the reference: factor on density, > 0
    bool identical = false;  ///< no T differs
};

/// Compares two depth images; the second is scaled to the extinction of the first. If both are
/// empty (all T = 0), relative_l2 is 0 and bias 1; if only the reference is, both are infinite.
/// throws  vog::Error if the sizes differ, or a T is negative or not finite
[[nodiscard]] DepthDifference compare(const DepthImage& reference, const DepthImage& image);

/// Compares two depth images as colours: both at the extinction of the reference, shaded with one
/// transfer function on black.
/// throws  vog::Error as compare and shade do
[[nodiscard]] PictureDifference compare_shaded(const DepthImage& reference, const DepthImage& image,
                                               const TransferFunction& tf);

/// Options of difference_map.
struct DifferenceMapOptions {
    /// Difference at the end of the colour scale, in 1/255, >= 0. 0: the largest difference in the
    /// images, rounded up to 1, 2 or 5 times a power of ten.
    double limit = 0;
    bool bar = true;  ///< add the colour scale with its numbers on the right, 76 pixels wide
};

/// Heat map of V - V_ref, V = 1 - exp(-T), at the extinction of the reference: blue below zero, red
/// above, grey at zero.
/// throws  vog::Error if the sizes differ, or for a limit that is negative or not finite
[[nodiscard]] Image difference_map(const DepthImage& reference, const DepthImage& image,
                                   const DifferenceMapOptions& options = {});
/// Heat map of the largest absolute difference of the three channels; black where equal.
/// throws  vog::Error as the one above
[[nodiscard]] Image difference_map(const Image& reference, const Image& image,
                                   const DifferenceMapOptions& options = {});

}  // namespace vog
