// image_files.h: formats of image files, and the decoders behind read_image.
#pragma once

#include <filesystem>

#include "vog/image.h"

namespace vog::image_files {

enum class ImageFormat { kPng, kExr, kOther };

/// Format by the first bytes, independent of the name.
/// throws vog::Error if `file` cannot be read
ImageFormat image_format(const std::filesystem::path& file);

Image read_png(const std::filesystem::path& file);
Image read_exr(const std::filesystem::path& file);

/// Writes float32 channels as they are, pixel by pixel, lossless.
/// names  of the channels
void write_exr(const std::filesystem::path& file, int width, int height,
               const std::vector<const char*>& names, const std::vector<float>& interleaved);

}  // namespace vog::image_files
