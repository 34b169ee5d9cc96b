// moment_cut.h: which cells of the moment octree to part, by halves: the best cut for a number of
// Gaussians.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "convert/moment_field.h"
#include "convert/moment_halves.h"
#include "vog/moments.h"

namespace vog {

inline constexpr std::uint32_t kNoBrick = 0xffffffffu;

/// Everything a cut is chosen from: made once, cut as often as one likes.
struct CutTree {
    MomentOctree octree;            ///< cells of 8^3 and up; those without children are bricks
    std::span<const Brick> bricks;  ///< with mass, in Morton order
    std::vector<std::vector<std::uint32_t>> brick_of;  ///< [level][cell]: its brick, or kNoBrick
    std::vector<std::vector<Halves>> cell_halves;      ///< [level][cell]; of bricks: theirs below
    std::vector<std::array<Halves, kBrickNodes>> brick_halves;
    HalfFloat most_gain = 0;  ///< no split is worth more
};

/// The field must outlive the tree. cost: O(voxels) time, 1.3 kB to each leaf
/// scale  makes the gains of several fields comparable: cut_scale of their voxels
CutTree cut_tree(const MomentField& field, double scale = 1);
double cut_scale(double voxel_edge);

/// At most `budget` cells of all trees together, at least one of each: the cut of most worth at the
/// price that leaves as many (price_search.h). May fall short of the budget where several splits
/// are worth the same.
/// returns for each tree its cells in Morton order of the octree's, means as indices
std::vector<std::vector<Moments>> best_cut(std::span<const CutTree> trees, std::size_t budget);

/// Cells of the finest cut: samples with mass.
std::size_t finest_count(const CutTree& tree);

}  // namespace vog
