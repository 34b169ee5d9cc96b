// index_map.h: the index map from the voxels of a volume to those of a field's grid.
#pragma once

#include <algorithm>
#include <optional>

#include "vog/volume.h"

namespace vog::field_files {

/// Positions of voxels of one lattice in another.
struct IndexMap {
    Affine map;                 ///< indices of the field's grid from indices of the volume
    bool same_lattice = false;  ///< the map is a whole shift, to a thousandth of a voxel

    Vec3d operator()(Vec3i voxel) const {
        const Vec3d p = map(vec_cast<double>(voxel));
        return same_lattice ? Vec3d{std::round(p.x), std::round(p.y), std::round(p.z)} : p;
    }
};

/// Map between two lattices.
/// voxels  box of the volume's indices, in which the lattices are compared
inline IndexMap index_map(const Affine& world_from_voxel, const Affine& world_from_index,
                          const Box& voxels) {
    const Mat3 index_from_world = inverse(world_from_index.linear);
    // The difference of translations first: both may be far from the origin.
    IndexMap result;
    result.map.linear = index_from_world * world_from_voxel.linear;
    result.map.translation =
        index_from_world * (world_from_voxel.translation - world_from_index.translation);
    const auto round = [](Vec3d p) {
        return Vec3d{std::round(p.x), std::round(p.y), std::round(p.z)};
    };
    const Vec3d shift = round(result.map(voxels.lower) - voxels.lower);
    constexpr double kTolerance = 1e-3;  // voxels: transforms are often float32
    result.same_lattice = true;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d at{corner & 1 ? voxels.upper.x : voxels.lower.x,
                       corner & 2 ? voxels.upper.y : voxels.lower.y,
                       corner & 4 ? voxels.upper.z : voxels.lower.z};
        const Vec3d off = result.map(at) - at - shift;
        for (int axis = 0; axis < 3; ++axis)
            result.same_lattice &= std::abs(off[axis]) <= kTolerance;
    }
    if (result.same_lattice) result.map = {Mat3{}, shift};
    return result;
}

}  // namespace vog::field_files
