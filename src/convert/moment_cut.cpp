// moment_cut.cpp: priorities of splitting, top down, and the cut above a priority.
#include "convert/moment_cut.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "parallel.h"

namespace vog {

namespace {

/// Up to eight children with mass.
struct Children {
    std::array<Moments, 8> cell;
    std::size_t count = 0;
    std::span<const Moments> cells() const { return std::span(cell).first(count); }
};

Children brick_children(const Brick& brick, const BrickSums& sums, std::size_t n) {
    Children children;
    for (std::size_t child = 8 * n + 1; child <= 8 * n + 8; ++child) {
        const Moments moments = brick_node(brick, sums, child);
        if (moments.mass > 0) children.cell[children.count++] = moments;
    }
    return children;
}

/// Finds the brick of each childless cell: level by level the same nodes in the same order.
void find_bricks(CutTree& tree) {
    const auto& levels = tree.octree.levels;
    tree.brick_of.resize(levels.size());
    for (std::size_t level = 0; level < levels.size(); ++level) {
        const std::vector<MomentCell>& cells = levels[level].cells;
        tree.brick_of[level].assign(cells.size(), kNoBrick);
        const double spacing = std::ldexp(1.0, levels[level].edge_log2) / kLeafEdge;
        std::size_t cell = 0;
        for (std::size_t b = 0; b < tree.bricks.size(); ++b) {
            if (tree.bricks[b].spacing != spacing) continue;
            while (cells[cell].child_count > 0) ++cell;
            tree.brick_of[level][cell++] = static_cast<std::uint32_t>(b);
        }
    }
}

/// Infinite stays infinite; whatever the scale, a finite gain stays finite.
float scaled(float gain, double scale) {
    if (std::isinf(gain)) return gain;
    return static_cast<float>(
        std::min(gain * scale, static_cast<double>(std::numeric_limits<float>::max())));
}

/// Priorities of the cells of one level, none higher than the parent's.
void set_cell_priorities(CutTree& tree, std::size_t level, double scale) {
    const auto& levels = tree.octree.levels;
    const std::vector<MomentCell>& cells = levels[level].cells;
    std::vector<float>& priority = tree.cell_priority[level];
    vog::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t n) {
        const MomentCell& cell = cells[n];
        if (cell.child_count == 0) return;
        const MomentLevel& finer = levels[level - 1];
        Children children;
        children.count = cell.child_count;
        for (std::uint32_t child = 0; child < cell.child_count; ++child)
            children.cell[child] =
                cell_moments(finer.cells[cell.first_child + child], finer.edge_log2);
        const double edge = std::ldexp(1.0, levels[level].edge_log2);
        priority[n] = std::min(
            priority[n],
            scaled(split_gain(cell_moments(cell, levels[level].edge_log2), children.cells(), edge),
                   scale));
        for (std::uint32_t child = 0; child < cell.child_count; ++child)
            tree.cell_priority[level - 1][cell.first_child + child] = priority[n];
    });
}

/// Priorities inside a brick, none higher than `above`; appends its splits.
void set_brick_priorities(const Brick& brick, float above, double scale,
                          std::array<float, kBrickNodes>& priority,
                          std::vector<CutTree::Split>& splits) {
    const BrickSums sums = brick_sums(brick);
    priority.fill(0);
    for (std::size_t n = 0; n < kBrickNodes; ++n) {
        const Moments node = brick_node(brick, sums, n);
        if (!(node.mass > 0)) continue;
        const Children children = brick_children(brick, sums, n);
        const double edge = (n == 0 ? 8 : n < 9 ? 4 : 2) * brick.spacing;
        const float gain = scaled(split_gain(node, children.cells(), edge), scale);
        priority[n] = std::min(gain, n == 0 ? above : priority[(n - 1) / 8]);
        splits.push_back({priority[n], static_cast<std::uint32_t>(children.count - 1)});
    }
}

/// Lists every split, highest priority first.
void list_splits(CutTree& tree, const std::vector<std::vector<CutTree::Split>>& of_bricks) {
    const auto& levels = tree.octree.levels;
    for (std::size_t level = 0; level < levels.size(); ++level)
        for (std::size_t n = 0; n < levels[level].cells.size(); ++n)
            if (const std::uint32_t children = levels[level].cells[n].child_count; children > 0)
                tree.splits.push_back({tree.cell_priority[level][n], children - 1});
    for (const auto& part : of_bricks)
        tree.splits.insert(tree.splits.end(), part.begin(), part.end());
    sort_splits(tree.splits);
}

/// Walks down from the root, depth first, and takes the cells that stay whole.
struct CutWalk {
    const CutTree& tree;
    float least;  ///< nodes of this priority or more are split
    std::vector<Moments> cut{};

    void take_brick_node(std::size_t b, const BrickSums& sums, std::size_t node) {
        if (node < kBrickNodes && tree.brick_priority[b][node] >= least) {
            for (std::size_t child = 8 * node + 1; child <= 8 * node + 8; ++child)
                take_brick_node(b, sums, child);
            return;
        }
        const Moments moments = brick_node(tree.bricks[b], sums, node);
        if (moments.mass > 0) cut.push_back(moments);
    }
    void take_cell(std::size_t level, std::size_t n) {
        look_in();
        if (const std::uint32_t b = tree.brick_of[level][n]; b != kNoBrick)
            return take_brick_node(b, brick_sums(tree.bricks[b]), 0);
        const MomentLevel& at = tree.octree.levels[level];
        const MomentCell& cell = at.cells[n];
        if (tree.cell_priority[level][n] < least) {
            cut.push_back(cell_moments(cell, at.edge_log2));
            return;
        }
        for (std::uint32_t child = 0; child < cell.child_count; ++child)
            take_cell(level - 1, cell.first_child + child);
    }
};

}  // namespace

CutTree cut_tree(const MomentField& field, double priority_scale) {
    CutTree tree;
    tree.octree = brick_octree(field.bricks, field.world_from_index);
    tree.bricks = field.bricks;
    find_bricks(tree);

    // Top down, so that each node's parent is known.
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const auto& levels = tree.octree.levels;
    for (const MomentLevel& level : levels)
        tree.cell_priority.emplace_back(level.cells.size(), kInfinity);
    for (std::size_t level = levels.size(); level-- > 1;)
        set_cell_priorities(tree, level, priority_scale);
    std::vector<float> above(tree.bricks.size(), kInfinity);
    for (std::size_t level = 0; level < levels.size(); ++level)
        for (std::size_t n = 0; n < levels[level].cells.size(); ++n)
            if (tree.brick_of[level][n] != kNoBrick)
                above[tree.brick_of[level][n]] = tree.cell_priority[level][n];

    tree.brick_priority.resize(tree.bricks.size());
    std::vector<std::vector<CutTree::Split>> splits((tree.bricks.size() + kNodeChunk - 1) /
                                                    kNodeChunk);
    vog::parallel_for(std::size_t{0}, splits.size(), [&](std::size_t chunk) {
        const std::size_t last = std::min((chunk + 1) * kNodeChunk, tree.bricks.size());
        for (std::size_t b = chunk * kNodeChunk; b < last; ++b)
            set_brick_priorities(tree.bricks[b], above[b], priority_scale, tree.brick_priority[b],
                                 splits[chunk]);
    });
    list_splits(tree, splits);
    return tree;
}

void sort_splits(std::vector<CutTree::Split>& splits) {
    tbb::parallel_sort(
        splits.begin(), splits.end(), [](const CutTree::Split& a, const CutTree::Split& b) {
            return a.priority != b.priority ? a.priority > b.priority : a.added < b.added;
        });
}

float least_priority(std::span<const CutTree::Split> splits, std::size_t budget,
                     std::size_t roots) {
    // Splits of one priority go together: a parent's may be its child's.
    std::size_t count = roots;
    float least = std::numeric_limits<float>::infinity();  // of single children: no count
    for (std::size_t n = 0; n < splits.size();) {
        std::size_t last = n, added = 0;
        for (; last < splits.size() && splits[last].priority == splits[n].priority; ++last)
            added += splits[last].added;
        if (count + added > budget) break;
        count += added;
        least = splits[n].priority;
        n = last;
    }
    return least;
}

std::vector<Moments> cut_at(const CutTree& tree, float least) {
    if (tree.octree.levels.empty()) return {};
    CutWalk walk{tree, least};
    walk.take_cell(tree.octree.levels.size() - 1, 0);
    return walk.cut;
}

std::vector<std::vector<Moments>> best_cut(std::span<const CutTree> trees, std::size_t budget) {
    std::vector<CutTree::Split> all;
    if (trees.size() > 1) {
        for (const CutTree& tree : trees)
            all.insert(all.end(), tree.splits.begin(), tree.splits.end());
        sort_splits(all);
    }
    const float least =
        least_priority(trees.size() == 1 ? trees[0].splits : all, budget, trees.size());
    std::vector<std::vector<Moments>> cuts;
    for (const CutTree& tree : trees) cuts.push_back(cut_at(tree, least));
    return cuts;
}

std::size_t finest_count(const CutTree& tree) {
    std::size_t count = 1;
    for (const CutTree::Split& split : tree.splits) count += split.added;
    return count;
}

}  // namespace vog
