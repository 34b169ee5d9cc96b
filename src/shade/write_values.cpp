// write_values.cpp: Files of float32 values: NumPy's .npy and .exr.
#include <fmt/core.h>

#include <bit>
#include <fstream>

#include "core/atomic_file.h"
#include "data/image_checks.h"
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

}  // namespace

void write_values(const std::filesystem::path& file, const DepthImage& values) {
    const std::string extension = file.extension().string();
    if (extension == ".exr") return write_exr(file, values);
    if (extension != ".npy")
        throw Error(fmt::format("{}: cannot write '{}' for values, expected .npy or .exr",
                                file.string(), extension));
    require_valid(file.string(), values);
    static_assert(std::endian::native == std::endian::little);
    write_file(file, [&](std::ofstream& out) {
        out << npy_header(values.width, values.height);
        out.write(reinterpret_cast<const char*>(values.depth.data()),
                  static_cast<std::streamsize>(values.depth.size() * sizeof(float)));
    });
}

}  // namespace vog
