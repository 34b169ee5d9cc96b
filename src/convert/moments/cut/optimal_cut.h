// optimal_cut.h: the cut through the moment octree with the largest total gain for a number of
// Gaussians:
// optimal tree pruning (Chou, Lookabaugh, Gray 1989).
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

/// In CutTree::brick_of: the cell has children.
inline constexpr std::uint32_t kNoBrick = 0xffffffffu;

/// The octree of a field with the gains of all its splits. Serves cuts of any size.
struct CutTree {
    MomentOctree octree;            ///< cells of 8^3 voxels and more
    std::span<const Brick> bricks;  ///< all bricks of the field, in Morton order
    std::vector<std::vector<std::uint32_t>>
        brick_of;  ///< [level][cell]: index in bricks, or kNoBrick
    std::vector<std::vector<BinarySplits>> cell_splits;  ///< [level][cell]; empty for bricks
    BigVector<BinarySplits> brick_splits;                ///< nodes with mass of all bricks
    std::vector<std::size_t> first_splits;  ///< index of each brick's first, and the end
    BFloat16 most_gain = 0;                 ///< largest gain of any split

    /// Splits of brick b's nodes with mass: the whole, then cells of 4, then of 2 samples.
    std::span<const BinarySplits> splits_of_brick(std::size_t b) const {
        return std::span(brick_splits)
            .subspan(first_splits[b], first_splits[b + 1] - first_splits[b]);
    }
};

/// field    must outlive the tree
/// scale    factor on all gains, which makes those of several fields comparable: cut_scale
/// carried  components of carried fields (carried_values.h)
/// cost     O(voxels) time, up to 1.3 kB for each leaf
CutTree cut_tree(const LatticeField& field, double scale = 1,
                 std::span<const LatticeField* const> carried = {});
/// Unit of the gains of a field.
/// voxel_edge  in any unit that all fields share
double cut_scale(double voxel_edge);

/// Optimal prunings of all trees under the multiplier at which they have at most `budget` cells
/// together (lagrange_search.h), at least one of each tree. Fewer cells where several splits have
/// one gain.
/// returns  for each tree its cells, in Morton order of the octree's
std::vector<PackedCells> best_cut(std::span<const CutTree> trees, std::size_t budget);

/// Cells of the finest cut: all samples with mass.
std::size_t finest_count(const CutTree& tree);

}  // namespace vog::moments
