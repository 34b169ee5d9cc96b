// optimal_cut.cpp: gains of all splits and the optimal pruning, both bottom up; its cells, top
// down.
#include "convert/moments/cut/optimal_cut.h"

#include <algorithm>
#include <cmath>

#include "convert/moments/cut/lagrange_search.h"
#include "convert/moments/cut/split_gain.h"
#include "convert/moments/cut/visibility.h"
#include "core/parallel.h"

namespace vog::moments {

namespace {

/// Moments of the octants of node n of a brick.
Octants brick_octants(const Brick& brick, const BrickSums& sums, std::size_t n) {
    Octants octants;
    for (std::size_t o = 0; o < 8; ++o) octants[o] = brick_node(brick, sums, 8 * n + 1 + o);
    return octants;
}

/// Children of a cell by octant. Octants are relative to the lowest child, not to the cell, because
/// the root's children may lie on both sides of an aligned plane.
struct CellOctants {
    std::array<std::uint32_t, 8> child{};  ///< index in the finer level
    std::uint8_t occupied = 0;
};
CellOctants cell_octants(const MomentOctree& octree, std::size_t level, const MomentCell& cell) {
    CellOctants octants;
    const std::vector<MomentCell>& finer = octree.levels[level - 1].cells;
    Vec3i lowest = finer[cell.first_child].origin;
    for (std::uint32_t n = 0; n < cell.child_count; ++n)
        for (int axis = 0; axis < 3; ++axis)
            lowest[axis] = std::min(lowest[axis], finer[cell.first_child + n].origin[axis]);
    for (std::uint32_t n = 0; n < cell.child_count; ++n) {
        const Vec3i origin = finer[cell.first_child + n].origin;
        const std::size_t octant = (origin.x > lowest.x ? 4 : 0) + (origin.y > lowest.y ? 2 : 0) +
                                   (origin.z > lowest.z ? 1 : 0);
        octants.child[octant] = cell.first_child + n;
        octants.occupied |= static_cast<std::uint8_t>(1 << octant);
    }
    return octants;
}

/// Moments of the children, cells of the next finer level.
Octants octant_moments(const MomentOctree& octree, std::size_t level, const CellOctants& children) {
    const MomentLevel& finer = octree.levels[level - 1];
    Octants octants;
    for (std::size_t o = 0; o < 8; ++o)
        if (children.occupied >> o & 1)
            octants[o] = cell_moments(finer.cells[children.child[o]], finer.edge_log2);
    return octants;
}

/// Sets brick_of: the childless cells of a level are the bricks of its size, in the same order.
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

/// Number of nodes of a brick with mass, samples aside.
std::size_t node_count(const Brick& brick) {
    if (!brick.leaf) return kBrickNodes;
    std::uint64_t twos = 0;
    std::uint8_t fours = 0;
    for (int n = 0; n < 64; ++n) {
        const Vec3i place = morton_place(n);
        const float* v =
            brick.leaf->value.data() + leaf_offset(2 * place.x, 2 * place.y, 2 * place.z);
        const bool has_mass = v[0] > 0 || v[1] > 0 || v[8] > 0 || v[9] > 0 || v[64] > 0 ||
                              v[65] > 0 || v[72] > 0 || v[73] > 0;
        twos |= std::uint64_t{has_mass} << n;
        fours |= static_cast<std::uint8_t>(has_mass << n / 8);
    }
    return 1 + static_cast<std::size_t>(std::popcount(fours) + std::popcount(twos));
}

/// Index of the first child of node n in a brick's list of nodes with mass; the end of the list if
/// the children are samples.
std::size_t first_inside(std::span<const BinarySplits> splits, std::size_t n) {
    if (n == 0) return 1;
    const auto fours = static_cast<std::size_t>(std::popcount(splits[0].occupied));
    if (n > fours) return splits.size();
    std::size_t first = 1 + fours;
    for (std::size_t four = 1; four < n; ++four)
        first += static_cast<std::size_t>(std::popcount(splits[four].occupied));
    return first;
}

/// Brick b of a lattice and of the components of fields that it carries.
struct CarryingBrick {
    const Brick& brick;
    std::vector<const Brick*> carried;
};

/// Sets the splits of all nodes of a brick, bottom up. Visibility is evaluated for cells of 4^3
/// samples and larger; smaller cells take their parent's.
/// least_part  as of splits_of
/// with_mass   out: the nodes with mass, in order
/// returns     extent of the brick
Extent set_brick_splits(const CarryingBrick& both, const VisibilityWeight& visibility, double scale,
                        double least_part, std::span<BinarySplits> with_mass) {
    const Brick& brick = both.brick;
    std::array<BinarySplits, kBrickNodes> splits{};
    const BrickSums sums = brick_sums(brick);
    const std::array<Extent, kBrickNodes> extents = brick_extents(brick);
    std::vector<BrickSums> carried_sums;
    for (const Brick* carried : both.carried) carried_sums.push_back(brick_sums(*carried));
    std::vector<Octants> carried(both.carried.size());
    std::array<double, 9> weight{};
    for (std::size_t n = 0; n < 9; ++n)
        if (const Moments node = brick_node(brick, sums, n); node.mass > 0)
            weight[n] = scale * visibility(node.mean);
    for (std::size_t n = kBrickNodes; n-- > 0;) {
        if (n < 9 ? !(weight[n] > 0) : !(sums.twos[n - 9].mass > 0)) continue;
        if (!brick.leaf && n >= 9 && n % 8 != 0) {  // siblings in a tile are alike
            splits[n] = splits[n + 1];
            continue;
        }
        for (std::size_t c = 0; c < carried.size(); ++c)
            carried[c] = brick_octants(*both.carried[c], carried_sums[c], n);
        Extents octants;  // samples side by side have no gaps
        if (n < 9) std::copy_n(extents.begin() + 8 * std::ptrdiff_t(n) + 1, 8, octants.begin());
        splits[n] = splits_of(brick_octants(brick, sums, n), weight[n < 9 ? n : (n - 1) / 8],
                              carried, octants, least_part);
        const double edge = brick.spacing * (n < 1 ? 8 : n < 9 ? 4 : 2);
        if (edge <= brick.voxel) splits[n].axes |= BinarySplits::kOneVoxel;
        if (n < 9)
            for (std::size_t child = 8 * n + 1; child <= 8 * n + 8; ++child)
                splits[n].max_gain = std::max(splits[n].max_gain, splits[child].max_gain);
    }
    std::copy_if(splits.begin(), splits.end(), with_mass.begin(),
                 [](const BinarySplits& node) { return node.occupied != 0; });
    return extents[0];
}

/// Optimal pruning of node n of a brick and all below.
/// n            index in the brick's list
/// split_masks  out, in the order of the list
Subtree pruned_brick(std::span<const BinarySplits> splits, std::size_t n, double lambda,
                     std::array<std::uint8_t, kBrickNodes>& split_masks) {
    split_masks[n] = 0;
    if (splits[n].is_one_voxel() || double{from_bfloat16(splits[n].max_gain)} <= lambda)
        return {0, 1};
    std::array<Subtree, 8> octants;
    std::size_t inside = first_inside(splits, n);
    const bool samples = inside == splits.size();
    for (std::size_t o = 0; o < 8; ++o)
        if (splits[n].occupied >> o & 1)
            octants[o] =
                samples ? Subtree{0, 1} : pruned_brick(splits, inside++, lambda, split_masks);
    return pruned(splits[n], octants, lambda, split_masks[n]);
}

/// Optimal pruning of a tree under the multiplier lambda.
class PrunedTree {
  public:
    PrunedTree(const CutTree& tree, double lambda) : tree_(tree), lambda_(lambda) {
        const auto& levels = tree.octree.levels;
        for (std::size_t level = 0; level < levels.size(); ++level) {
            best_.emplace_back(levels[level].cells.size());
            split_masks_.emplace_back(levels[level].cells.size());
            vog::parallel_for(std::size_t{0}, best_[level].size(),
                              [&](std::size_t n) { best_[level][n] = best(level, n); });
        }
    }
    std::size_t count() const { return best_.empty() ? 0 : best_.back()[0].count; }
    PackedCells cells() const {
        PackedCells cut(tree_.bricks);
        cut.reserve(count());
        if (!best_.empty()) add_cell(best_.size() - 1, 0, cut);
        return cut;
    }

  private:
    Subtree best(std::size_t level, std::size_t n) {
        if (const std::uint32_t b = tree_.brick_of[level][n]; b != kNoBrick) {
            std::array<std::uint8_t, kBrickNodes> split_masks{};
            return pruned_brick(tree_.splits_of_brick(b), 0, lambda_, split_masks);
        }
        if (tree_.cell_splits[level][n].is_one_voxel()) return {0, 1};
        const CellOctants children =
            cell_octants(tree_.octree, level, tree_.octree.levels[level].cells[n]);
        std::array<Subtree, 8> octants;
        for (std::size_t o = 0; o < 8; ++o)
            if (children.occupied >> o & 1) octants[o] = best_[level - 1][children.child[o]];
        return pruned(tree_.cell_splits[level][n], octants, lambda_, split_masks_[level][n]);
    }
    /// place  of node n in the brick's list of nodes with mass
    void add_brick_node(std::size_t b, const BrickSums& sums,
                        const std::array<std::uint8_t, kBrickNodes>& split_masks, std::size_t n,
                        std::size_t place, PackedCells& cut) const {
        const std::span<const BinarySplits> splits = tree_.splits_of_brick(b);
        const Octants octants = brick_octants(tree_.bricks[b], sums, n);
        const std::size_t inside = first_inside(splits, place);
        for_each_part(splits[place], split_masks[place], [&](std::uint8_t mask) {
            const std::size_t child = 8 * n + 1 + static_cast<std::size_t>(std::countr_zero(mask));
            const auto before = static_cast<std::uint8_t>(splits[place].occupied & (mask - 1));
            if (std::has_single_bit(mask) && child < kBrickNodes)
                add_brick_node(b, sums, split_masks, child,
                               inside + static_cast<std::size_t>(std::popcount(before)), cut);
            else
                cut.push_back(joined_octants(octants, mask));
        });
    }
    void add_cell(std::size_t level, std::size_t n, PackedCells& cut) const {
        if (const std::uint32_t b = tree_.brick_of[level][n]; b != kNoBrick) {
            std::array<std::uint8_t, kBrickNodes> split_masks{};
            pruned_brick(tree_.splits_of_brick(b), 0, lambda_, split_masks);
            return add_brick_node(b, brick_sums(tree_.bricks[b]), split_masks, 0, 0, cut);
        }
        const CellOctants children =
            cell_octants(tree_.octree, level, tree_.octree.levels[level].cells[n]);
        const Octants octants = octant_moments(tree_.octree, level, children);
        for_each_part(tree_.cell_splits[level][n], split_masks_[level][n], [&](std::uint8_t mask) {
            if (std::has_single_bit(mask))
                add_cell(level - 1,
                         children.child[static_cast<std::size_t>(std::countr_zero(mask))], cut);
            else
                cut.push_back(joined_octants(octants, mask));
        });
    }

    const CutTree& tree_;
    double lambda_;
    std::vector<std::vector<Subtree>> best_;              ///< [level][cell]
    std::vector<std::vector<std::uint8_t>> split_masks_;  ///< [level][cell]
};

}  // namespace

CutTree cut_tree(const LatticeField& field, double scale,
                 std::span<const LatticeField* const> carried) {
    CutTree tree;
    tree.octree = brick_octree(field.bricks);
    tree.bricks = field.bricks;
    find_bricks(tree);

    std::vector<MomentOctree> carried_octrees;  // of the same cells
    for (const LatticeField* values : carried)
        carried_octrees.push_back(brick_octree(values->bricks));

    const VisibilityWeight visibility(field);
    // As many parts as are no cost have a Gaussian of their own; smaller ones are of no weight.
    const auto& levels = tree.octree.levels;
    const double least_part =
        levels.empty() ? 0 : double{levels.back().cells[0].mass} * (0.999 / kSmallCount);
    tree.first_splits.resize(tree.bricks.size() + 1);
    for (std::size_t b = 0; b < tree.bricks.size(); ++b)
        tree.first_splits[b + 1] = tree.first_splits[b] + node_count(tree.bricks[b]);
    tree.brick_splits.resize(tree.first_splits.back());
    std::vector<Extent> of_bricks(tree.bricks.size()), finer;
    vog::parallel_for(std::size_t{0}, tree.bricks.size(), [&](std::size_t b) {
        CarryingBrick both{tree.bricks[b], {}};
        for (const LatticeField* values : carried) both.carried.push_back(&values->bricks[b]);
        of_bricks[b] = set_brick_splits(both, visibility, scale, least_part,
                                        std::span(tree.brick_splits).subspan(tree.first_splits[b]));
    });
    for (std::size_t level = 0; level < levels.size(); ++level) {
        const std::vector<MomentCell>& cells = levels[level].cells;
        const double edge = std::ldexp(1.0, levels[level].edge_log2);
        tree.cell_splits.emplace_back(cells.size());
        std::vector<Extent> extents(cells.size());
        vog::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t n) {
            if (const std::uint32_t b = tree.brick_of[level][n]; b != kNoBrick) {
                extents[n] = of_bricks[b];
                return;
            }
            const CellOctants children = cell_octants(tree.octree, level, cells[n]);
            Extents octants;
            for (std::size_t o = 0; o < 8; ++o)
                if (children.occupied >> o & 1) octants[o] = finer[children.child[o]];
            extents[n] = joined_extents(octants, children.occupied);
            const Vec3d mean = cell_moments(cells[n], levels[level].edge_log2).mean;
            BinarySplits& splits = tree.cell_splits[level][n];
            std::vector<Octants> values;
            for (const MomentOctree& octree : carried_octrees)
                values.push_back(octant_moments(octree, level, children));
            splits = splits_of(octant_moments(tree.octree, level, children),
                               scale * visibility(mean), values, octants, least_part);
            if (edge <= extents[n].voxel) splits.axes |= BinarySplits::kOneVoxel;
        });
        finer = std::move(extents);
    }
    for (const auto& level : tree.cell_splits)
        for (const BinarySplits& splits : level)
            tree.most_gain = std::max(tree.most_gain, splits.max_gain);
    for (const BinarySplits& splits : tree.brick_splits)
        tree.most_gain = std::max(tree.most_gain, splits.max_gain);
    return tree;
}

double cut_scale(double voxel_edge) { return gain_scale(voxel_edge, DepthPower::quarter); }

std::vector<PackedCells> best_cut(std::span<const CutTree> trees, std::size_t budget) {
    double max_gain = 0;
    for (const CutTree& tree : trees)
        max_gain = std::max(max_gain, double{from_bfloat16(tree.most_gain)});
    const double lambda = lambda_of_budget(budget, max_gain, [&](double tried) {
        std::size_t count = 0;
        for (const CutTree& tree : trees) count += PrunedTree(tree, tried).count();
        return count;
    });
    std::vector<PackedCells> cuts;
    for (const CutTree& tree : trees) cuts.push_back(PrunedTree(tree, lambda).cells());
    return cuts;
}

std::size_t finest_count(const CutTree& tree) { return PrunedTree(tree, kSplitAll).count(); }

}  // namespace vog::moments
