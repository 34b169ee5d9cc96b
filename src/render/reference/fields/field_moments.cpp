// field_moments.cpp: Density times powers of a field, voxel by voxel.
#include "render/reference/fields/field_moments.h"

#include <algorithm>
#include <limits>

#include "core/parallel.h"

namespace vog::reference {

ComponentRanges::ComponentRanges(FieldPart part)
    : component_{part == FieldPart::y   ? 1
                 : part == FieldPart::z ? 2
                                        : 0} {
    if (part == FieldPart::view) component_ = {0, 1, 2};
    ends_.assign(2 * component_.size(), -std::numeric_limits<double>::infinity());
}

void ComponentRanges::include(std::span<const Volume> volumes, std::span<const VoxelField> fields) {
    for (std::size_t n = 0; n < component_.size(); ++n) {
        const auto include_value = [&](float value) {
            ends_[2 * n] = std::max(ends_[2 * n], -double{value});
            ends_[2 * n + 1] = std::max(ends_[2 * n + 1], double{value});
        };
        for (std::size_t v = 0; v < volumes.size(); ++v) {
            const VoxelValues& values =
                fields[v].component[static_cast<std::size_t>(component_[n])];
            for (std::size_t leaf = 0; leaf < values.leaf.size(); ++leaf)
                for (int i = 0; i < kLeafVoxels; ++i)
                    if (volumes[v].leaves[leaf].active(i))
                        include_value(values.leaf[leaf][static_cast<std::size_t>(i)]);
            for (const float value : values.tile) include_value(value);
        }
    }
}

MomentUnits ComponentRanges::units(const Collective* processes) {
    if (processes) processes->max(ends_);
    MomentUnits units;
    units.component = component_;
    for (std::size_t n = 0; n < component_.size(); ++n) {
        const double low = -ends_[2 * n], high = ends_[2 * n + 1];
        const int axis = static_cast<int>(n);
        if (low <= high) units.lower[axis] = low;
        if (low < high) units.unit[axis] = high - low;
    }
    return units;
}

Volume moment_volume(const Volume& volume, const VoxelField& field, const MomentUnits& units, int a,
                     int b) {
    Volume moment = volume;
    for (const int n : {a, b}) {
        if (n < 0) continue;
        const auto component =
            static_cast<std::size_t>(units.component[static_cast<std::size_t>(n)]);
        const VoxelValues& values = field.component[component];
        const double lower = units.lower[n], per_unit = 1 / units.unit[n];
        const auto times = [&](float& weight, float value) {
            weight = static_cast<float>(double{weight} * (double{value} - lower) * per_unit);
        };
        vog::parallel_for(std::size_t{0}, moment.leaves.size(), [&](std::size_t leaf) {
            for (int i = 0; i < kLeafVoxels; ++i)
                if (const auto at = static_cast<std::size_t>(i); moment.leaves[leaf].active(i))
                    times(moment.leaves[leaf].value[at], values.leaf[leaf][at]);
        });
        for (std::size_t tile = 0; tile < moment.tiles.size(); ++tile)
            times(moment.tiles[tile].value, values.tile[tile]);
    }
    return moment;
}

}  // namespace vog::reference
