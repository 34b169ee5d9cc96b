// nano_tree.h: Writes a volume as a NanoVDB grid of floats, node by node into one buffer.
#pragma once

#include <nanovdb/NanoVDB.h>

#include "core/aligned_buffer.h"
#include "vog/volume.h"

namespace vog::reference {

using NanoRoot = nanovdb::NanoRoot<float>;
using NanoUpper = nanovdb::NanoUpper<float>;  ///< 32^3 cells of 128 voxels
using NanoLower = nanovdb::NanoLower<float>;  ///< 16^3 cells of 8 voxels
using NanoLeaf = nanovdb::NanoLeaf<float>;    ///< 8^3 voxels

/// A NanoVDB grid that owns its memory; valid by NanoVDB's own checks, as a test verifies.
struct NanoTree {
    NanoBuffer buffer;

    const nanovdb::NanoGrid<float>& grid() const {
        return *reinterpret_cast<const nanovdb::NanoGrid<float>*>(buffer.data());
    }
    const NanoRoot& root() const { return grid().tree().root(); }
};

/// Converts a volume: leaves to leaves with 0 in inactive voxels, tiles to tiles of the same level.
/// with_border  for trilinear interpolation, where cells just below active voxels are not 0: includes
///              them in the boxes of nodes, and adds active tiles of value 0 for empty 8^3 blocks
///              with an occupied block above them in x, y or z
/// throws       vog::Error for overlapping nodes or indices beyond 2^30
NanoTree nano_tree(const Volume& volume, bool with_border);

}  // namespace vog::reference
