// grey.h: what the figures and the maps of differences share: sizes that agree, and 8-bit values.
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

/// Factor that takes the T of `image` to the extinction of `reference`.
double to_extinction_of(const DepthImage& reference, const DepthImage& image);

/// V = 1 - exp(-factor T), of 255, not rounded.
inline double visibility_255(float depth, double factor) {
    return -255 * std::expm1(-factor * static_cast<double>(depth));
}

/// V as 8-bit grey: round(255 V).
std::vector<std::uint8_t> grey_bytes(const DepthImage& image, double factor);

struct Rgb8 {
    std::uint8_t channel[3];
};
/// round(255 c) of colours over black.
std::vector<Rgb8> color_bytes(const Image& image);

}  // namespace vog::comparison
