// made_fields.h: fields that are functions of the place.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "vog/voxel_field.h"

namespace vog::test {

/// The field that is a volume's own values.
inline VoxelField own() {
    VoxelField field;
    field.component.resize(1);
    return field;
}

/// A field of any function of the world position, at the voxels of a volume.
template <class Function>
VoxelValues values_of(const Volume& volume, const Function& function) {
    VoxelValues values;
    for (const Leaf& leaf : volume.leaves) {
        auto& of = values.leaf.emplace_back();
        for (int n = 0; n < kLeafVoxels; ++n)
            if (leaf.active(n))
                of[static_cast<std::size_t>(n)] =
                    static_cast<float>(function(volume.world_from_index(
                        vec_cast<double>(leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7}))));
    }
    for (const Tile& tile : volume.tiles) {
        const double half = 0.5 * (tile.edge - 1);
        values.tile.push_back(static_cast<float>(function(
            volume.world_from_index(vec_cast<double>(tile.origin) + Vec3d{half, half, half}))));
    }
    return values;
}

/// Sets the range from the values; of a vector by its largest component.
inline void set_range(VoxelField& field) {
    field.lower = 1e30, field.upper = -1e30;
    const auto include = [&](float value) {
        const double number = field.is_vector() ? std::abs(double{value}) : double{value};
        field.lower = std::min(field.lower, number), field.upper = std::max(field.upper, number);
    };
    for (const VoxelValues& values : field.component) {
        for (const auto& leaf : values.leaf)
            for (const float value : leaf) include(value);
        for (const float value : values.tile) include(value);
    }
}

/// A scalar field of one function, a vector field of three.
template <class... Function>
VoxelField field_of(const std::string& name, const Volume& volume, const Function&... function) {
    VoxelField field;
    field.name = name, field.unit = "K";
    (field.component.push_back(values_of(volume, function)), ...);
    set_range(field);
    return field;
}

}  // namespace vog::test
