// reference_grid.h: what a VoxelGrid holds.
#pragma once

#include "render/reference_tree.h"
#include "vog/reference.h"

namespace vog {

struct VoxelGrid::Data {
    VoxelGridOptions options;
    NanoTree tree;
    Vec3d corner;           ///< index of the local origin: the lower corner of the active box
    Vec3d world_corner;     ///< the same point in the world
    Mat3 local_from_world;  ///< of directions
};

}  // namespace vog
