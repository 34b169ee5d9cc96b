// image_checks.h: limits on the size of images, and checks of their values.
#pragma once

#include <cstdint>
#include <string>

#include "vog/image.h"

namespace vog {

/// Larger images are refused, so that a few hostile bytes cannot claim all memory. 2^28 pixels are
/// 16384 x 16384: 1 GiB of T, 4 GiB of colours.
inline constexpr std::int64_t kMaxImageSide = 65536;
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 28;

/// throws vog::Error unless the size is positive and within the limits above
void require_valid_size(const std::string& where, std::int64_t width, std::int64_t height);

/// throws vog::Error unless the size fits the pixels and no component is NaN
void require_valid(const std::string& where, const Image& image);

/// throws vog::Error unless the size fits the pixels, every T is finite and >= 0, and the
/// extinction is finite and > 0
void require_valid(const std::string& where, const DepthImage& image);

}  // namespace vog
