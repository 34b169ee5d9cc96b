// leaf_file.h: files of leaves for the codecs of floats: which voxels are active without loss, their values by a codec.
#pragma once

#include <cstdint>
#include <filesystem>

#include "evaluate/rate/float_codecs.h"
#include "vog/volume.h"

namespace vog::evaluation {

/// Active voxels of a file of leaves.
enum class LeafMask {
    stored,  ///< 512 bits a leaf that is not dense; inactive voxels continue active ones, so that they cost little
    none,    ///< inactive voxels are zeros like others; active is what is decoded above 0
};

/// Writes a volume: transform, origins, masks and tiles compressed by zstd, values by a codec and then by zstd.
/// tolerance  largest error of a value, > 0
/// returns    bytes of all but the values
/// throws     vog::Error if the file cannot be written
std::uint64_t write_leaf_file(const std::filesystem::path& file, const Volume& volume,
                              const FloatCodec& codec, double tolerance, LeafMask mask);

/// Reads a file of write_leaf_file. Values below 0, which a codec makes of small ones, are 0.
/// throws  vog::Error for a missing, truncated or corrupt file
Volume read_leaf_file(const std::filesystem::path& file, const FloatCodec& codec);

}  // namespace vog::evaluation
