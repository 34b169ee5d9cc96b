// pfm.h: Reads and writes depth images as PFM files, which need no library, for machines with only CUDA.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "vog/error.h"
#include "vog/image.h"

namespace vog::test {

inline void write_pfm(const std::filesystem::path& file, const DepthImage& image) {
    std::ofstream out(file, std::ios::binary);
    out << "Pf\n" << image.width << " " << image.height << "\n-1.0\n";  // little-endian
    for (int row = image.height - 1; row >= 0; --row)
        out.write(
            reinterpret_cast<const char*>(&image.depth[static_cast<std::size_t>(row) *
                                                       static_cast<std::size_t>(image.width)]),
            image.width * static_cast<std::streamsize>(sizeof(float)));
    if (!out.flush()) throw Error(file.string() + ": cannot write");
}

inline DepthImage read_pfm(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string magic, scale;
    int width = 0, height = 0;
    in >> magic >> width >> height >> scale;
    in.get();
    if (!in || magic != "Pf" || scale != "-1.0" || width < 1 || height < 1)
        throw Error(file.string() + ": not a PFM file of tests/gpu/prepare.sh");
    DepthImage image(width, height);
    for (int row = height - 1; row >= 0; --row)
        in.read(reinterpret_cast<char*>(
                    &image.depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(width)]),
                width * static_cast<std::streamsize>(sizeof(float)));
    if (!in) throw Error(file.string() + ": truncated");
    return image;
}

}  // namespace vog::test
