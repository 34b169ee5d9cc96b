// moment_cut.h: which nodes of the moment octree to split: the best cut for a number of Gaussians.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "convert/moment_field.h"
#include "vog/moments.h"

namespace vog {

inline constexpr std::uint32_t kNoBrick = 0xffffffffu;

/// Everything a cut is chosen from: made once, cut as often as one likes.
struct CutTree {
    MomentOctree octree;            ///< cells of 8^3 and up; those without children are bricks
    std::span<const Brick> bricks;  ///< with mass, in Morton order
    std::vector<std::vector<std::uint32_t>> brick_of;  ///< [level][cell]: its brick, or kNoBrick
    /// Priority of splitting a node: its gain, or its parent's priority where that is lower, so
    /// that splitting all nodes from some priority on always gives a cut.
    std::vector<std::vector<float>> cell_priority;  ///< [level][cell]; of bricks: theirs below
    std::vector<std::array<float, kBrickNodes>> brick_priority;

    struct Split {
        float priority;
        std::uint32_t added;  ///< Gaussians that splitting adds
    };
    std::vector<Split> splits;  ///< of all nodes, highest priority first
};

/// The field must outlive the tree. cost: O(voxels) time, 0.4 kB to each leaf and up to 0.6 kB
/// more
/// priority_scale  makes the priorities of several fields comparable: gain_scale of their voxels
CutTree cut_tree(const MomentField& field, double priority_scale = 1);

/// Highest priority first.
void sort_splits(std::vector<CutTree::Split>& splits);
/// The least priority that is split where at most `budget` cells shall be left.
/// splits  of all nodes, sorted
/// roots   cells before any split
float least_priority(std::span<const CutTree::Split> splits, std::size_t budget,
                     std::size_t roots = 1);
/// The cells that stay whole where nodes of this priority or more are split.
/// returns cells in Morton order, means as indices
std::vector<Moments> cut_at(const CutTree& tree, float least);

/// At most `budget` cells of all trees together, at least one of each: the nodes of highest
/// priority are split.
/// returns for each tree its cells
std::vector<std::vector<Moments>> best_cut(std::span<const CutTree> trees, std::size_t budget);

/// Cells of the finest cut: samples with mass.
std::size_t finest_count(const CutTree& tree);

/// What splitting `parent` into `children` (all with mass) gains, per Gaussian added:
/// |G_parent - sum G_child|^2 in closed form for untruncated kernels, relative to the column's own
/// depth. Infinite for a single child.
/// edge  of the parent's cube, voxels
float split_gain(const Moments& parent, std::span<const Moments> children, double edge);
/// What a gain in voxels of this edge is to be multiplied with, to be in units of the edge's.
double gain_scale(double voxel_edge);

}  // namespace vog
