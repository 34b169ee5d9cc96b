// optimal_cut.h: which cells of the moment octree to part, by halves: the best cut for a number of
// Gaussians.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "convert/moments/cells/lattice_field.h"
#include "convert/moments/cells/octree.h"
#include "convert/moments/cells/packed_cells.h"
#include "convert/moments/cut/binary_splits.h"
#include "vog/memory.h"

namespace vog::moments {

inline constexpr std::uint32_t kNoBrick = 0xffffffffu;

/// Everything a cut is chosen from: made once, cut as often as one likes.
struct CutTree {
    MomentOctree octree;            ///< cells of 8^3 and up; those without children are bricks
    std::span<const Brick> bricks;  ///< with mass, in Morton order
    std::vector<std::vector<std::uint32_t>> brick_of;    ///< [level][cell]: its brick, or kNoBrick
    std::vector<std::vector<BinarySplits>> cell_splits;  ///< [level][cell]; of bricks: theirs below
    BigVector<BinarySplits> brick_splits;                ///< of all bricks' nodes with mass
    std::vector<std::size_t> first_splits;               ///< of each brick, and the end
    BFloat16 most_gain = 0;                              ///< no split is worth more

    /// Of a brick's nodes with mass: the whole, its fours, their twos.
    std::span<const BinarySplits> splits_of_brick(std::size_t b) const {
        return std::span(brick_splits)
            .subspan(first_splits[b], first_splits[b + 1] - first_splits[b]);
    }
};

/// The field must outlive the tree. cost: O(voxels) time, up to 1.3 kB to each leaf
/// scale  makes the gains of several fields comparable: cut_scale of their voxels
CutTree cut_tree(const LatticeField& field, double scale = 1);
double cut_scale(double voxel_edge);

/// At most `budget` cells of all trees together, at least one of each: the cut of most worth at the
/// price that leaves as many (price_search.h). May fall short of the budget where several splits
/// are worth the same.
/// returns for each tree its cells in Morton order of the octree's
std::vector<PackedCells> best_cut(std::span<const CutTree> trees, std::size_t budget);

/// Cells of the finest cut: samples with mass.
std::size_t finest_count(const CutTree& tree);

}  // namespace vog::moments
