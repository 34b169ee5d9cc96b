// image_files.h: formats of image files, and the decoders behind read_image.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "vog/image.h"

namespace vog::image_files {

enum class ImageFormat { kPng, kExr, kOther };

/// Format by the first bytes, independent of the name.
/// throws vog::Error if `file` cannot be read
ImageFormat image_format(const std::filesystem::path& file);

Image read_png(const std::filesystem::path& file);
Image read_exr(const std::filesystem::path& file);

/// Record of a picture (vog/picture_record.h) in its file; empty: none.
/// throws  vog::Error for a file that cannot be read
std::string png_record(const std::filesystem::path& file);
std::string exr_record(const std::filesystem::path& file);

/// Whether an EXR has these channels and no others.
bool has_channels(const std::filesystem::path& file, const std::array<const char*, 3>& names);
/// Values of three float32 channels, pixel by pixel.
/// throws vog::Error for a file that is not whole, and for channels of other types
std::vector<std::array<float, 3>> read_channels(const std::filesystem::path& file,
                                                const std::array<const char*, 3>& names, int& width,
                                                int& height);

/// Writes float32 channels as they are, pixel by pixel, lossless.
/// names  of the channels
void write_exr(const std::filesystem::path& file, int width, int height,
               const std::vector<const char*>& names, const std::vector<float>& interleaved,
               const std::string& record = {});

}  // namespace vog::image_files
