// image_files.cpp: which format a file is, and whether an image is fit to be written or returned.
#include "io/image_files.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "io/atomic_file.h"
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

ImageFormat image_format(const std::filesystem::path& file) {
    require_readable(file);
    constexpr std::array<unsigned char, 8> kPngMagic{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    constexpr std::array<unsigned char, 4> kExrMagic{0x76, 0x2f, 0x31, 0x01};
    std::array<char, 8> start{};
    std::ifstream(file, std::ios::binary).read(start.data(), start.size());
    const auto starts_with = [&](const auto& magic) {
        return std::equal(magic.begin(), magic.end(), start.begin(), [](unsigned char a, char b) {
            return a == static_cast<unsigned char>(b);
        });
    };
    if (starts_with(kPngMagic)) return ImageFormat::kPng;
    if (starts_with(kExrMagic)) return ImageFormat::kExr;
    return ImageFormat::kOther;
}

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

Image read_image(const std::filesystem::path& file) {
    switch (image_format(file)) {
        case ImageFormat::kPng:
            return read_png(file);
        case ImageFormat::kExr:
            return read_exr(file);
        case ImageFormat::kOther:
            break;
    }
    throw Error(fmt::format("{}: neither a PNG nor an EXR image", file.string()));
}

void write_image(const std::filesystem::path& file, const Image& image) {
    const std::string extension = file.extension().string();
    if (extension == ".png") return write_png(file, image);
    if (extension == ".exr") return write_exr(file, image);
    throw Error(fmt::format("{}: extension '{}', expected .png or .exr", file.string(), extension));
}

}  // namespace vog
