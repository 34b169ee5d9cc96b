// vog/image.h: depth images (optical depth T) and colour images, and their files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace vog {

/// Optical depth along the ray of each pixel, rows from the top. T = 0: the ray met nothing.
struct DepthImage {
    int width = 0, height = 0;
    std::vector<float> depth;  ///< [height * width], dimensionless, >= 0
    double extinction = 1;     ///< the factor on density that `depth` includes

    DepthImage() = default;
    DepthImage(int width_px, int height_px)
        : width(width_px),
          height(height_px),
          depth(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}
    float& at(int column, int row) {
        return depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(column)];
    }
    float at(int column, int row) const {
        return depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(column)];
    }
};

struct Rgba {
    float r = 0, g = 0, b = 0, a = 1;
    friend bool operator==(const Rgba&, const Rgba&) = default;
};

/// Colours as displayed (no tone mapping, no gamma), straight alpha, rows from the top.
struct Image {
    int width = 0, height = 0;
    std::vector<Rgba> pixel;  ///< [height * width], components in [0, 1]

    Image() = default;
    Image(int width_px, int height_px)
        : width(width_px),
          height(height_px),
          pixel(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}
    Rgba& at(int column, int row) {
        return pixel[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(column)];
    }
    const Rgba& at(int column, int row) const {
        return pixel[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(column)];
    }
};

/// The extinction at which the 99th percentile of the non-zero T is 4 (`--extinction auto`),
/// whatever the extinction of `image`. Percentile by nearest rank: of n sorted values, number
/// ceil(0.99 n). returns 1 for an image without any T > 0
double auto_extinction(const DepthImage& image);
/// Multiplies every T by extinction / image.extinction: changing extinction never re-renders.
/// throws vog::Error unless extinction is finite and > 0 and every T stays finite
void set_extinction(DepthImage& image, double extinction);

/// Whether no alpha is below 1: what decides between RGB and RGBA.
bool opaque(const Image& image);
/// round(255 c), clamped, by pixels: 3 a pixel, or 4 with alpha.
std::vector<std::uint8_t> image_bytes(const Image& image, bool with_alpha);
/// The file that write_png writes. throws vog::Error as it does
std::vector<std::uint8_t> png_bytes(const Image& image);
/// 8 bits a channel, round(255 c), clamped; RGB, or RGBA if any alpha is below 1.
/// Every writer writes beside the file and renames. throws vog::Error if it cannot, and for an
/// image without pixels, with NaN, or above 65536 pixels a side or 2^28 in all (readers refuse
/// those too)
void write_png(const std::filesystem::path& file, const Image& image);
/// Float32 RGBA, lossless ZIP. As EXR has it, colours in the file are multiplied by alpha;
/// read_image divides again, so where alpha is 0 the colour is lost.
void write_exr(const std::filesystem::path& file, const Image& image);
/// write_png or write_exr by extension. throws vog::Error for any other
void write_image(const std::filesystem::path& file, const Image& image);
/// One float32 channel Y = T, lossless ZIP, with the double attribute `extinction`.
/// throws vog::Error also for a T that is negative or not finite
void write_exr(const std::filesystem::path& file, const DepthImage& image);

/// A PNG of any depth and colour type (values as stored: no gamma, no profile), or an EXR with R,
/// G, B and optionally A, float32 or half. The content decides, not the name. throws vog::Error on
/// anything else, and on a file that is not whole
Image read_image(const std::filesystem::path& file);
/// An EXR with the one float32 channel Y; extinction 1 if the attribute is absent.
/// throws vog::Error on anything else, a file that is not whole, or a T negative or not finite
DepthImage read_depth(const std::filesystem::path& file);
/// Whether `file` is an EXR that holds only Y: a depth image rather than a colour image.
/// throws vog::Error for a file that cannot be read
bool is_depth_file(const std::filesystem::path& file);

}  // namespace vog
