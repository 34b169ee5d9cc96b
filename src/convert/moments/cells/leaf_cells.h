// leaf_cells.h: loop over the occupied cells of one leaf or tile.
#pragma once

#include <algorithm>
#include <cmath>

#include "convert/moments/cells/morton_nodes.h"

namespace vog::moments {

/// Calls take(sums, center) for each occupied cube of a node, in Morton order: MomentSums about the
/// centre of the cube, Vec3d centre in index space.
/// edge  of the cubes, voxels; 1, 2, 4 or 8
template <class Take>
void for_each_cell(const Volume& volume, const MortonNode& node, int edge, const Take& take) {
    if (node.tile) {
        // At most 8^3 cubes, as in a leaf: at edge 1 a tile of 4096^3 voxels would have 7e10.
        const Tile& tile = volume.tiles[node.index];
        if (tile.value <= 0) return;
        const int across = std::clamp(tile.edge / edge, 1, kLeafEdge), side = tile.edge / across;
        const MomentSums sums =
            cube_sums(tile.value * std::pow(static_cast<double>(side), 3), side);
        for (int n = 0; n < across * across * across; ++n)
            take(sums, cube_center(tile.origin + side * morton_place(n), side));
        return;
    }
    const Leaf& leaf = volume.leaves[node.index];
    if (edge == 1) {
        for (int n = 0; n < kLeafVoxels; ++n) {
            const Vec3i place = morton_place(n);
            const float value =
                leaf.value[static_cast<std::size_t>(leaf_offset(place.x, place.y, place.z))];
            if (value > 0) take(cube_sums(value, 1), vec_cast<double>(leaf.origin + place));
        }
        return;
    }
    const auto take_all = [&](const auto& cells) {
        for (std::size_t n = 0; n < cells.size(); ++n)
            if (cells[n].mass > 0)
                take(cells[n],
                     cube_center(leaf.origin + edge * morton_place(static_cast<int>(n)), edge));
    };
    const LeafSums<2> twos = leaf_sums(leaf);
    if (edge == 2) return take_all(twos);
    const LeafSums<4> fours = merge_eight<2>(twos);
    if (edge == 4) return take_all(fours);
    take_all(merge_eight<4>(fours));
}

}  // namespace vog::moments
