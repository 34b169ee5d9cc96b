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

}  // namespace vog::image_files
