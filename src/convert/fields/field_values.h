// field_values.h: loop over the voxels of a field and their densities.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "core/paging.h"
#include "vog/volume.h"
#include "vog/voxel_field.h"

namespace vog::joint {

/// Calls take(density, value, volume) for each voxel and tile with mass: its density, which may be changed, value of the
/// component, and volume in the unit of voxel_volume.
/// parts  volumes, const or not
/// field  [parts]; without leaves and tiles the volume's own values
template <class Part, class Take>
void for_each_value(std::span<Part> parts, const std::vector<VoxelField>& field,
                    std::size_t component, const Take& take) {
    for (std::size_t n = 0; n < parts.size(); ++n) {
        const VoxelValues& values = field[n].component[component];
        const bool own = values.leaf.empty() && values.tile.empty();
        const double voxel = voxel_volume(parts[n]);
        for (std::size_t leaf = 0; leaf < parts[n].leaves.size(); ++leaf) {
            keep_memory();
            for (std::size_t k = 0; k < kLeafVoxels; ++k)
                if (auto& density = parts[n].leaves[leaf].value[k]; density > 0)
                    take(density, own ? density : values.leaf[leaf][k], voxel);
        }
        for (std::size_t tile = 0; tile < parts[n].tiles.size(); ++tile) {
            auto& [origin, edge, density] = parts[n].tiles[tile];
            if (density > 0)
                take(density, own ? density : values.tile[tile], voxel * std::pow(edge, 3));
        }
    }
}

}  // namespace vog::joint
