// own_field.cpp: a volume's own values as a field.
#include "vog/voxel_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/paging.h"
#include "core/parallel.h"

namespace vog {

namespace {

/// Calls take(leaf, offset, value) for active voxels and take_tile(value) for tiles; returns the volume's
/// name and the range of its values.
template <class Take, class TakeTile>
VoxelField with_range(const Volume& volume, const std::string& name, const Take& take,
                      const TakeTile& take_tile) {
    float lower = std::numeric_limits<float>::infinity(), upper = -lower;
    const double voxel = voxel_volume(volume);
    VoxelField field;
    field.background = volume.background;
    const auto include = [&](float density, double voxels) {
        const auto value = static_cast<float>(double{density} + field.background);
        lower = std::min(lower, value);
        upper = std::max(upper, value);
        field.counts.add(value, double{density} * voxels * voxel);
        return value;
    };
    for (std::size_t n = 0; n < volume.leaves.size(); ++n) {
        check_interrupt();
        const Leaf& leaf = volume.leaves[n];
        for (int offset = 0; offset < kLeafVoxels; ++offset) {
            if (!leaf.active(offset)) continue;
            const auto at = static_cast<std::size_t>(offset);
            take(n, at, include(leaf.value[at], 1));
        }
    }
    for (const Tile& tile : volume.tiles) {
        take_tile(include(tile.value, std::pow(double(tile.edge), 3)));
    }
    field.name = name.empty() ? volume.name : name;
    if (lower <= upper) field.lower = double{lower}, field.upper = double{upper};
    return field;
}

}  // namespace

ValueCounts value_counts(const Volume& volume, const VoxelValues& values) {
    const double voxel = voxel_volume(volume);
    ValueCounts counts;
    for (std::size_t l = 0; l < volume.leaves.size(); ++l) {
        check_interrupt();
        for (int n = 0; n < kLeafVoxels; ++n) {
            const auto at = static_cast<std::size_t>(n);
            if (volume.leaves[l].active(n))
                counts.add(values.leaf[l][at], double{volume.leaves[l].value[at]} * voxel);
        }
    }
    for (std::size_t t = 0; t < volume.tiles.size(); ++t)
        counts.add(values.tile[t], double{volume.tiles[t].value} *
                                       std::pow(double(volume.tiles[t].edge), 3) * voxel);
    return counts;
}

VoxelField own_field(const Volume& volume, const std::string& name) {
    VoxelValues values;
    resize_kept(values.leaf, volume.leaves.size());
    VoxelField field = with_range(
        volume, name,
        [&](std::size_t leaf, std::size_t at, float value) { values.leaf[leaf][at] = value; },
        [&](float value) { values.tile.push_back(value); });
    field.component.push_back(std::move(values));
    return field;
}

VoxelField measure_field(const Volume& volume, const std::string& name) {
    VoxelField field = with_range(
        volume, name, [](std::size_t, std::size_t, float) {}, [](float) {});
    field.component.resize(1);
    field.unit = volume.units.density;
    return field;
}

}  // namespace vog
