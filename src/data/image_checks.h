// image_checks.h: size limits and value checks of images.
#pragma once

#include <cstdint>
#include <string>

#include "vog/image.h"

namespace vog {

/// Limits of images, so that a corrupt header cannot allocate all memory. 2^28 pixels are
/// 16384 x 16384: 1 GiB of T, 4 GiB of RGBA.
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
