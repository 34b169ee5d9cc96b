// grey.h: 8-bit values of images, and the check that two images have one size.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "vog/image.h"

namespace vog::comparison {

/// throws vog::Error naming both sizes if they differ, or if an image is empty or invalid
void require_same_size(const DepthImage& reference, const DepthImage& image);
void require_same_size(const Image& reference, const Image& image);

/// Factor from T of `image` to T at the extinction of `reference`.
double to_extinction_of(const DepthImage& reference, const DepthImage& image);

/// 255 V = 255 (1 - exp(-factor T)), not rounded.
inline double visibility_255(float depth, double factor) {
    return -255 * std::expm1(-factor * static_cast<double>(depth));
}

/// V as 8-bit grey: round(255 V).
std::vector<std::uint8_t> grey_bytes(const DepthImage& image, double factor);

/// 8-bit red, green, blue.
struct Rgb8 {
    std::uint8_t channel[3];
};
/// round(255 c) of the colours composited over black.
std::vector<Rgb8> color_bytes(const Image& image);

}  // namespace vog::comparison
