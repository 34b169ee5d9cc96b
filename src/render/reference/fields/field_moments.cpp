// field_moments.cpp: Density times powers of a field, voxel by voxel.
#include "render/reference/fields/field_moments.h"

#include <algorithm>
#include <limits>

#include "core/parallel.h"

namespace vog::reference {

MomentUnits moment_units(std::span<const Volume> volumes, std::span<const VoxelField> fields,
                         FieldPart part) {
    MomentUnits units;
    units.component = {part == FieldPart::y ? 1 : part == FieldPart::z ? 2 : 0};
    if (part == FieldPart::view) units.component = {0, 1, 2};
    for (std::size_t n = 0; n < units.component.size(); ++n) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        const auto include = [&](float value) {
            low = std::min(low, double{value});
            high = std::max(high, double{value});
        };
        for (std::size_t v = 0; v < volumes.size(); ++v) {
            const auto component = static_cast<std::size_t>(units.component[n]);
            const VoxelValues& values = fields[v].component[component];
            for (std::size_t leaf = 0; leaf < values.leaf.size(); ++leaf)
                for (int i = 0; i < kLeafVoxels; ++i)
                    if (volumes[v].leaves[leaf].active(i))
                        include(values.leaf[leaf][static_cast<std::size_t>(i)]);
            for (const float value : values.tile) include(value);
        }
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
