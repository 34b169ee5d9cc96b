// image_files.cpp: image formats by the first bytes of a file, and writers by extension.
#include "io/image/image_files.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "core/atomic_file.h"
#include "vog/error.h"

namespace vog {

using namespace image_files;

ImageFormat image_files::image_format(const std::filesystem::path& file) {
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

void write_image(const std::filesystem::path& file, const Image& image, const std::string& record) {
    const std::string extension = file.extension().string();
    if (extension == ".png") return write_png(file, image, record);
    if (extension == ".exr") return write_exr(file, image, record);
    throw Error(fmt::format("{}: extension '{}', expected .png or .exr", file.string(), extension));
}

}  // namespace vog
