// image.cpp: size limits and value checks of images.
#include "vog/image.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "data/image_checks.h"
#include "vog/error.h"

namespace vog {

namespace {

void require_pixel_count(const std::string& where, int width, int height, std::size_t pixels) {
    require_valid_size(where, width, height);
    if (pixels != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
        throw Error(fmt::format("{}: {} pixels for an image of {}x{}, expected {}", where, pixels,
                                width, height, std::int64_t{width} * height));
}

/// "pixel (column, row)" of the element at `index`.
std::string pixel_name(std::size_t index, int width) {
    const auto columns = static_cast<std::size_t>(width);
    return fmt::format("pixel ({}, {})", index % columns, index / columns);
}

}  // namespace

void require_valid_size(const std::string& where, std::int64_t width, std::int64_t height) {
    if (width < 1 || height < 1)
        throw Error(
            fmt::format("{}: image of {}x{} pixels, expected at least 1x1", where, width, height));
    if (width > kMaxImageSide || height > kMaxImageSide || width * height > kMaxImagePixels)
        throw Error(
            fmt::format("{}: image of {}x{} pixels, expected at most {} a side and {} in all",
                        where, width, height, kMaxImageSide, kMaxImagePixels));
}

void require_valid(const std::string& where, const Image& image) {
    require_pixel_count(where, image.width, image.height, image.pixel.size());
    const auto bad = std::find_if(image.pixel.begin(), image.pixel.end(), [](const Rgba& p) {
        return std::isnan(p.r) || std::isnan(p.g) || std::isnan(p.b) || std::isnan(p.a);
    });
    if (bad != image.pixel.end())
        throw Error(fmt::format(
            "{}: {} is ({}, {}, {}, {}), expected numbers", where,
            pixel_name(static_cast<std::size_t>(bad - image.pixel.begin()), image.width), bad->r,
            bad->g, bad->b, bad->a));
}

void require_valid(const std::string& where, const DepthImage& image) {
    require_pixel_count(where, image.width, image.height, image.depth.size());
    if (!(std::isfinite(image.extinction) && image.extinction > 0))
        throw Error(fmt::format("{}: extinction {}, expected a finite number above 0", where,
                                image.extinction));
    const auto bad = std::find_if(image.depth.begin(), image.depth.end(),
                                  [](float t) { return !(std::isfinite(t) && t >= 0); });
    if (bad != image.depth.end())
        throw Error(fmt::format(
            "{}: optical depth {} at {}, expected a finite number >= 0", where, *bad,
            pixel_name(static_cast<std::size_t>(bad - image.depth.begin()), image.width)));
}

}  // namespace vog
