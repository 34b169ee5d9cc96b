// nano_tree.h: a volume as a NanoVDB grid of floats, written node by node into one buffer.
#pragma once

#include <nanovdb/NanoVDB.h>

#include "core/aligned_buffer.h"
#include "vog/volume.h"

namespace vog::reference {

using NanoRoot = nanovdb::NanoRoot<float>;
using NanoUpper = nanovdb::NanoUpper<float>;  ///< 32^3 cells of 128 voxels
using NanoLower = nanovdb::NanoLower<float>;  ///< 16^3 cells of 8 voxels
using NanoLeaf = nanovdb::NanoLeaf<float>;    ///< 8^3 voxels

/// A NanoVDB grid in memory of its own, valid by NanoVDB's own checks (tests hold it to that).
struct NanoTree {
    NanoBuffer buffer;

    const nanovdb::NanoGrid<float>& grid() const {
        return *reinterpret_cast<const nanovdb::NanoGrid<float>*>(buffer.data());
    }
    const NanoRoot& root() const { return grid().tree().root(); }
};

/// Leaves become leaves with zero in inactive voxels, tiles become tiles of their own level.
/// with_border: also counts in the cells just below active voxels, from where trilinear
/// interpolation reaches them: in the boxes of nodes, and as active tiles of value 0 where an 8^3
/// block holds nothing but one above it (in x, y or z) does.
/// throws vog::Error for overlapping nodes or indices beyond 2^30
NanoTree nano_tree(const Volume& volume, bool with_border);

}  // namespace vog::reference
