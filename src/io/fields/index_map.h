// index_map.h: the index map from the voxels of a volume to those of a field's grid.
#pragma once

#include <cmath>

#include "vog/volume.h"

namespace vog::field_files {

/// Positions of voxels of one lattice in another.
struct IndexMap {
    Affine map;                 ///< indices of the field's grid from indices of the volume
    bool same_lattice = false;  ///< the map is a whole shift

    Vec3d operator()(Vec3i voxel) const { return map(vec_cast<double>(voxel)); }
};

/// Map between two lattices. Where all centres of voxels lie within a thousandth of a voxel of those of the grid, in whatever order of
/// its axes, the map has whole numbers: values need no interpolation then.
/// voxels  box of the volume's indices, in which the lattices are compared
inline IndexMap index_map(const Affine& world_from_voxel, const Affine& world_from_index,
                          const Box& voxels) {
    const Mat3 index_from_world = inverse(world_from_index.linear);
    // The difference of translations first: both may be far from the origin.
    const Affine exact{
        index_from_world * world_from_voxel.linear,
        index_from_world * (world_from_voxel.translation - world_from_index.translation)};
    const auto round = [](Vec3d p) {
        return Vec3d{std::round(p.x), std::round(p.y), std::round(p.z)};
    };
    Affine whole;
    for (std::size_t axis = 0; axis < 3; ++axis)
        whole.linear.row[axis] = round(exact.linear.row[axis]);
    whole.translation = round(exact(voxels.lower) - whole.linear * voxels.lower);
    constexpr double kTolerance = 1e-3;  // voxels: transforms are often float32
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d at{corner & 1 ? voxels.upper.x : voxels.lower.x,
                       corner & 2 ? voxels.upper.y : voxels.lower.y,
                       corner & 4 ? voxels.upper.z : voxels.lower.z};
        const Vec3d off = exact(at) - whole(at);
        for (int axis = 0; axis < 3; ++axis)
            if (!(std::abs(off[axis]) <= kTolerance)) return {exact, false};
    }
    return {whole, whole.linear == Mat3{}};
}

}  // namespace vog::field_files
