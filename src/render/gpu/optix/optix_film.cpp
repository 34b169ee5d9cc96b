// optix_film.cpp: Output buffers, and the points of pixels through which each launch sends its rays.
#include "render/gpu/optix/optix_film.h"

#include <fmt/core.h>

#include "vog/error.h"

namespace vog::gpu {

void check_samples(int samples) {
    constexpr int kMostSamples = 64;
    if (samples < 1 || samples > kMostSamples)
        throw Error(
            fmt::format("{} x {} rays a pixel, expected 1 to {}", samples, samples, kMostSamples));
}

void OptixFilm::load(int width, int height, int samples) {
    width_ = width, height_ = height, samples_ = samples;
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    depth_.reserve(pixels, "the picture");
    if (samples > 1) sum_.reserve(pixels, "the sum of samples");
}

device::Film OptixFilm::film(int n) const {
    const auto centre = [&](int part) { return (part + 0.5) / samples_ - 0.5; };
    return {depth_.data(),        samples_ > 1 ? sum_.data() : nullptr,
            depth_unit_,          centre(n % samples_),
            centre(n / samples_), n};
}

DepthImage OptixFilm::depth() const {
    DepthImage image(width_, height_);
    depth_.copy_to(image.depth.data(), image.depth.size(), "fetching the picture");
    return image;
}

}  // namespace vog::gpu
