// grey.cpp: 8-bit values of images, and checks before two images are compared.
#include "compare/grey.h"

#include <fmt/core.h>
#include <tbb/blocked_range.h>

#include "core/parallel.h"
#include "data/image_checks.h"
#include "vog/error.h"

namespace vog::comparison {

namespace {

template <class AnyImage>
void require_same(const AnyImage& reference, const AnyImage& image) {
    require_valid("reference", reference);
    require_valid("image", image);
    if (reference.width != image.width || reference.height != image.height)
        throw Error(fmt::format("the images differ in size: {}x{} pixels, expected {}x{}",
                                image.width, image.height, reference.width, reference.height));
}

template <class Pixel>
void for_pixels(std::size_t count, const Pixel& pixel) {
    vog::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1 << 14),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t n = range.begin(); n < range.end(); ++n) pixel(n);
                      });
}

std::uint8_t to_byte(float value) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
}

}  // namespace

void require_same_size(const DepthImage& reference, const DepthImage& image) {
    require_same(reference, image);
}
void require_same_size(const Image& reference, const Image& image) {
    require_same(reference, image);
}

double to_extinction_of(const DepthImage& reference, const DepthImage& image) {
    return reference.extinction / image.extinction;
}

std::vector<std::uint8_t> grey_bytes(const DepthImage& image, double factor) {
    std::vector<std::uint8_t> bytes(image.depth.size());
    for_pixels(bytes.size(), [&](std::size_t n) {
        bytes[n] = static_cast<std::uint8_t>(std::lround(visibility_255(image.depth[n], factor)));
    });
    return bytes;
}

std::vector<Rgb8> color_bytes(const Image& image) {
    std::vector<Rgb8> bytes(image.pixel.size());
    for_pixels(bytes.size(), [&](std::size_t n) {
        const Rgba& c = image.pixel[n];
        bytes[n] = {to_byte(c.r * c.a), to_byte(c.g * c.a), to_byte(c.b * c.a)};
    });
    return bytes;
}

}  // namespace vog::comparison
