// vog/image.h: depth images (optical depth T per pixel), colour images, and their files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace vog {

/// Optical depth T of the ray through each pixel: extinction times the integral of density along
/// the ray. Rows from the top. T = 0: empty space all along the ray.
struct DepthImage {
    int width = 0, height = 0;  ///< pixels
    std::vector<float> depth;   ///< [height * width] T, dimensionless, >= 0
    double extinction = 1;      ///< factor on density that `depth` includes, > 0

    DepthImage() = default;
    DepthImage(int width_px, int height_px)
        : width(width_px),
          height(height_px),
          depth(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}
    /// T at a pixel: column from the left, row from the top, from 0 on, unchecked.
    float& at(int column, int row) {
        return depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(column)];
    }
    float at(int column, int row) const {
        return depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(column)];
    }
};

/// Colour of a pixel.
struct Rgba {
    /// Red, green, blue as displayed, [0, 1]; alpha, [0, 1]: 0 transparent, 1 opaque.
    float r = 0, g = 0, b = 0, a = 1;
    friend bool operator==(const Rgba&, const Rgba&) = default;
};

/// Colour image: display values (no tone mapping, no gamma), alpha not multiplied into the colour,
/// rows from the top.
struct Image {
    int width = 0, height = 0;  ///< pixels
    std::vector<Rgba> pixel;    ///< [height * width] components in [0, 1]

    Image() = default;
    Image(int width_px, int height_px)
        : width(width_px),
          height(height_px),
          pixel(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}
    /// Colour of a pixel: column from the left, row from the top, from 0 on, unchecked.
    Rgba& at(int column, int row) {
        return pixel[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(column)];
    }
    const Rgba& at(int column, int row) const {
        return pixel[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(column)];
    }
};

/// Extinction at which the 99th percentile of the non-zero T is 4 (`--extinction auto`). The result
/// does not depend on image.extinction. Percentile by nearest rank: the sorted value number
/// ceil(0.99 n) of n.
/// returns  factor on density, > 0; 1 for an image without any T > 0
/// throws   vog::Error for a T that is negative or not finite, or an image without pixels
double auto_extinction(const DepthImage& image);
/// Changes the extinction of an image: multiplies every T by extinction / image.extinction, without
/// rendering again.
/// extinction  factor on density, finite, > 0
/// throws      vog::Error for an extinction out of range, or if a T would become infinite
void set_extinction(DepthImage& image, double extinction);

/// Whether no alpha is below 1. The writers store such an image without alpha.
bool opaque(const Image& image);
/// Components as bytes, round(255 c), clamped to [0, 255].
/// returns  [height * width * 3] red, green, blue; [height * width * 4] with alpha
std::vector<std::uint8_t> image_bytes(const Image& image, bool with_alpha);
/// Content of the file that write_png writes. throws vog::Error as write_png does
std::vector<std::uint8_t> png_bytes(const Image& image, const std::string& record = {});
/// Writes a PNG of 8 bits a channel, round(255 c), clamped; RGB, or RGBA if any alpha is below 1.
/// Like every writer here, writes beside the file and renames it when whole.
/// throws  vog::Error if the file cannot be written, and for an image without pixels, with NaN,
///         above 65536 pixels a side or above 2^28 in all (readers refuse those too)
/// record  text on how the picture was made (vog/picture_record.h); empty: none
void write_png(const std::filesystem::path& file, const Image& image,
               const std::string& record = {});
/// Writes an EXR of float32 RGBA with lossless ZIP. The file stores colours multiplied by alpha, as
/// EXR defines; read_image divides again, so a pixel of alpha 0 loses its colour.
/// throws  vog::Error as write_png does
void write_exr(const std::filesystem::path& file, const Image& image,
               const std::string& record = {});
/// Writes a PNG or an EXR, by the extension of `file`.
/// throws  vog::Error as these two do, and for any other extension
void write_image(const std::filesystem::path& file, const Image& image,
                 const std::string& record = {});
/// Writes a depth image as an EXR: one float32 channel Y = T, lossless ZIP, double attribute
/// `extinction`.
/// throws  vog::Error as write_png does, and for a T that is negative or not finite
void write_exr(const std::filesystem::path& file, const DepthImage& image,
               const std::string& record = {});

/// Reads a colour image: a PNG of any depth and colour type (values as stored: no gamma, no
/// profile), or an EXR with R, G, B and optionally A, float32 or half. The format is found by the
/// content, not by the name.
/// throws  vog::Error for any other content, and for a file that is not whole
Image read_image(const std::filesystem::path& file);
/// Reads a depth image: an EXR whose only channel is Y, float32. extinction is 1 if the file has no
/// such attribute.
/// throws  vog::Error for any other content, a file that is not whole, a T negative or not finite
DepthImage read_depth(const std::filesystem::path& file);
/// Whether a file is a depth image: an EXR whose only channel is Y.
/// throws  vog::Error for a file that cannot be read
bool is_depth_file(const std::filesystem::path& file);

}  // namespace vog
