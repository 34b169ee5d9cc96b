// nvdb_quantize.h: writing of volumes as .nvdb files of quantised floats.
#pragma once

#include <filesystem>

#include "vog/volume.h"

namespace vog::nvdb {

/// Values of a leaf in a .nvdb file.
enum class NanoCodes {
    f32,  ///< floats
    fp4,  ///< 4 bits a voxel between the least and the largest value of its leaf
    fp8,
    fp16,
    fpn,  ///< per leaf as many of 1, 2, 4, 8 and 16 bits as an absolute tolerance needs
};

/// Writes a volume by NanoVDB's own converter, without dithering, complete or not at all.
/// tolerance  of NanoCodes::fpn alone, in the unit of density, > 0; 16 bits are the finest
/// zip        entropy coder zip; else blosc
/// throws     vog::Error for an invalid or empty volume, or if the file cannot be written
void write_nvdb(const std::filesystem::path& file, const Volume& volume, NanoCodes codes,
                float tolerance, bool zip);

}  // namespace vog::nvdb
