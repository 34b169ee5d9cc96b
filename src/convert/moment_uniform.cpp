// moment_uniform.cpp: up to a leaf's edge from the bricks, beyond from the octree.
#include "convert/moment_uniform.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "parallel.h"

namespace vog {

namespace {

/// The cells of one size of a level of the octree, and the bricks above it. A level may be missing
/// only where the data are smaller than the block: then the last one stands for it.
std::vector<Moments> octree_cells(const MomentOctree& octree, int edge_log2) {
    std::vector<Moments> cells;
    std::size_t at = 0;
    while (at + 1 < octree.levels.size() && octree.levels[at].edge_log2 < edge_log2) ++at;
    for (std::size_t level = at; level < octree.levels.size(); ++level)
        for (const MomentCell& cell : octree.levels[level].cells)
            if (level == at || cell.child_count == 0)
                cells.push_back(cell_moments(cell, octree.levels[level].edge_log2));
    return cells;
}

}  // namespace

std::vector<Moments> uniform_cells(const MomentField& field, int block) {
    double largest = 1;
    for (const Brick& brick : field.bricks)
        if (brick.leaf) largest = std::max(largest, brick.spacing);
    if (block > kLeafEdge)
        return octree_cells(brick_octree(field.bricks, field.world_from_index),
                            std::countr_zero(unsigned(block)) + std::ilogb(largest));
    std::vector<std::vector<Moments>> parts((field.bricks.size() + kNodeChunk - 1) / kNodeChunk);
    vog::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t chunk) {
        const std::size_t last = std::min((chunk + 1) * kNodeChunk, field.bricks.size());
        for (std::size_t b = chunk * kNodeChunk; b < last; ++b) {
            const Brick& brick = field.bricks[b];
            // A tile is sampled by the eighth of its edge, which may be more than the block.
            const double samples = brick.leaf ? block : block * largest / brick.spacing;
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
    std::vector<Moments> cells;
    for (const auto& part : parts) cells.insert(cells.end(), part.begin(), part.end());
    return cells;
}

}  // namespace vog
