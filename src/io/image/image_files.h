// image_files.h: the formats of image files, and the two decoders that read_image chooses from.
#pragma once

#include <filesystem>

#include "vog/image.h"

namespace vog::image_files {

enum class ImageFormat { kPng, kExr, kOther };

/// By the first bytes, never by the name. throws vog::Error if `file` cannot be read
ImageFormat image_format(const std::filesystem::path& file);

Image read_png(const std::filesystem::path& file);
Image read_exr(const std::filesystem::path& file);

}  // namespace vog::image_files
