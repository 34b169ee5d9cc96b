// write_values.cpp: Files of float32 values: NumPy's .npy and .exr.
#include <fmt/core.h>

#include <bit>
#include <fstream>

#include "core/atomic_file.h"
#include "data/image_checks.h"
#include "io/image/image_files.h"
#include "vog/error.h"
#include "vog/quantity.h"

namespace vog {

namespace {

/// Header of NumPy's format 1.0 for [height, width] float32; its length is a multiple of 64.
std::string npy_header(int width, int height) {
    std::string text = fmt::format(
        "{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}), }}", height, width);
    constexpr std::size_t kPrefix = 10, kAlignment = 64;
    text.append(kAlignment - 1 - (kPrefix + text.size()) % kAlignment, ' ');
    text += '\n';
    std::string header("\x93NUMPY\x01\x00", 8);
    header += static_cast<char>(text.size() & 0xff);
    header += static_cast<char>(text.size() >> 8);
    return header + text;
}

/// Writes [height, width] float32 as .npy.
void write_npy(const std::filesystem::path& file, int width, int height,
               std::span<const float> values) {
    static_assert(std::endian::native == std::endian::little);
    write_file(file, [&](std::ofstream& out) {
        out << npy_header(width, height);
        out.write(reinterpret_cast<const char*>(values.data()),
                  static_cast<std::streamsize>(values.size() * sizeof(float)));
    });
}

}  // namespace

void write_values(const std::filesystem::path& file, const DepthImage& values,
                  const std::string& record) {
    const std::string extension = file.extension().string();
    if (extension == ".exr") return write_exr(file, values, record);
    if (extension != ".npy")
        throw Error(fmt::format("{}: cannot write '{}' for values, expected .npy or .exr",
                                file.string(), extension));
    require_valid(file.string(), values);
    write_npy(file, values.width, values.height, values.depth);
}

void write_map(const std::filesystem::path& file, const ValueMap& map) {
    require_valid_size(file.string(), map.width, map.height);
    if (file.extension() != ".npy")
        throw Error(fmt::format("{}: cannot write '{}' for one map, expected .npy", file.string(),
                                file.extension().string()));
    write_npy(file, map.width, map.height, map.value);
}

void write_channels(const std::filesystem::path& file, int width, int height,
                    std::span<const NamedValues> channels, const std::string& record) {
    require_valid_size(file.string(), width, height);
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::vector<const char*> names;
    for (const NamedValues& channel : channels) {
        if (channel.values.size() != pixels)
            throw Error(fmt::format("{}: channel {} has {} values, expected {}", file.string(),
                                    channel.name, channel.values.size(), pixels));
        names.push_back(channel.name.c_str());
    }
    std::vector<float> interleaved;
    interleaved.reserve(pixels * channels.size());
    for (std::size_t n = 0; n < pixels; ++n)
        for (const NamedValues& channel : channels) interleaved.push_back(channel.values[n]);
    image_files::write_exr(file, width, height, names, interleaved, record);
}

}  // namespace vog
