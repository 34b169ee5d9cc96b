// reference_grid.h: what a VoxelGrid holds.
#pragma once

#include "render/reference/hierarchical_dda.h"
#include "render/reference/nano_tree.h"
#include "vog/reference.h"

namespace vog {

struct VoxelGrid::Data {
    VoxelGridOptions options;
    reference::NanoTree tree;
    Vec3d corner;           ///< index of the local origin: the lower corner of the active box
    Vec3d world_corner;     ///< the same point in the world
    Mat3 local_from_world;  ///< of directions

    /// The ray in local coordinates where voxel i covers [i, i + 1), and where its centre is at i.
    /// Both share t with the world.
    reference::GridRay voxel_ray(Vec3d origin, Vec3d direction) const {
        return {local_from_world * (origin - world_corner) + Vec3d{0.5, 0.5, 0.5},
                local_from_world * direction};
    }
    reference::GridRay center_ray(Vec3d origin, Vec3d direction) const {
        return {local_from_world * (origin - world_corner), local_from_world * direction};
    }
};

}  // namespace vog
