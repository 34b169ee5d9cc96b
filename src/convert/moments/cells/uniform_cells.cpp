// uniform_cells.cpp: cells of up to 8 samples from the bricks, larger ones from the octree.
#include "convert/moments/cells/uniform_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "convert/moments/cells/leaf_cells.h"
#include "convert/moments/cells/octree.h"
#include "core/parallel.h"

namespace vog::moments {

namespace {

/// Cells of 2^edge_log2 voxels, and bricks larger than that, in Morton order.
PackedCells octree_cells(const MomentOctree& octree, std::span<const Brick> bricks, int edge_log2) {
    struct Place {
        Vec3i origin;
        std::size_t level, cell;
    };
    std::vector<Place> places;
    for (std::size_t level = 0; level < octree.levels.size(); ++level) {
        const auto& [level_log2, cells] = octree.levels[level];
        for (std::size_t n = 0; n < cells.size(); ++n)
            if (level_log2 == edge_log2 || (level_log2 > edge_log2 && cells[n].child_count == 0))
                places.push_back({cells[n].origin, level, n});
    }
    std::ranges::sort(places, morton_less, &Place::origin);
    PackedCells cells(bricks);
    cells.reserve(places.size());
    for (const Place& place : places) {
        const MomentLevel& level = octree.levels[place.level];
        cells.push_back(cell_moments(level.cells[place.cell], level.edge_log2));
    }
    return cells;
}

/// One cell for each voxel, also where seams of levels divide voxels.
PackedCells voxel_cells(const LatticeField& field) {
    PackedCells cells(field.bricks);
    for (const Volume* volume : field.volumes) {
        const LatticeStep to_field(*volume, field);
        for (const MortonNode& node : morton_nodes(*volume))
            for_each_cell(*volume, node, 1, [&](const MomentSums& sums, Vec3d center) {
                cells.push_back(to_field(sums, center));
            });
    }
    return cells;
}

}  // namespace

PackedCells uniform_cells(const LatticeField& field, int block) {
    if (block == 1) return voxel_cells(field);
    double largest = 1;
    for (const Brick& brick : field.bricks)
        if (brick.leaf) largest = std::max(largest, brick.spacing);
    if (block > kLeafEdge) {
        // The octree may have to grow beyond the data, as where a process holds a small part.
        const int edge_log2 = std::countr_zero(unsigned(block)) + std::ilogb(largest);
        return octree_cells(brick_octree(field.bricks, std::ldexp(1.0, edge_log2)), field.bricks,
                            edge_log2);
    }
    const PackedCells none(field.bricks);
    std::vector<PackedCells> parts((field.bricks.size() + kNodeChunk - 1) / kNodeChunk, none);
    vog::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t chunk) {
        const std::size_t last = std::min((chunk + 1) * kNodeChunk, field.bricks.size());
        for (std::size_t b = chunk * kNodeChunk; b < last; ++b) {
            const Brick& brick = field.bricks[b];
            // Samples per cell edge: more where voxels were divided. A sample of a tile, an eighth of
            // its edge, may exceed the block.
            const double samples = block * (brick.leaf ? brick.voxel : largest) / brick.spacing;
            const std::size_t first = samples >= 8   ? 0
                                      : samples >= 4 ? 1
                                      : samples >= 2 ? 9
                                                     : kBrickNodes;
            const std::size_t end = first == 0 ? 1 : 8 * first + 1;
            const BrickSums sums = brick_sums(brick);
            for (std::size_t n = first; n < end; ++n)
                if (const Moments cell = brick_node(brick, sums, n); cell.mass > 0)
                    parts[chunk].push_back(cell);
        }
    });
    return joined_cells(std::move(parts), none);
}

}  // namespace vog::moments
