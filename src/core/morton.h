// morton.h: the order in which cubes of every power of two are contiguous.
#pragma once

#include "vog/linear.h"

namespace vog {

/// Morton order of voxel indices: x before y before z where the highest differing bit is shared.
bool morton_less(Vec3i a, Vec3i b);

/// The corner of the cube of 2^edge_log2 voxels around an index.
inline Vec3i aligned(Vec3i index, int edge_log2) {
    for (int axis = 0; axis < 3; ++axis) index[axis] = index[axis] >> edge_log2 << edge_log2;
    return index;
}

}  // namespace vog
