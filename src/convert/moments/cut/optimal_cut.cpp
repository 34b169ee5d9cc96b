// optimal_cut.cpp: the gain of every split, bottom up; the best cut at a price, bottom up; its
// cells, top down.
#include "convert/moments/cut/optimal_cut.h"

#include <algorithm>
#include <cmath>

#include "convert/moments/cut/lagrange_search.h"
#include "convert/moments/cut/split_gain.h"
#include "convert/moments/cut/visibility.h"
#include "core/parallel.h"

namespace vog::moments {

namespace {

/// Octants of node n of a brick.
Octants brick_octants(const Brick& brick, const BrickSums& sums, std::size_t n) {
    Octants octants;
    for (std::size_t o = 0; o < 8; ++o) octants[o] = brick_node(brick, sums, 8 * n + 1 + o);
    return octants;
}

/// Children of a cell by where they lie. The root's may straddle an aligned plane: sides are told
/// from the lowest child, not from the cell.
struct CellOctants {
    std::array<std::uint32_t, 8> child{};  ///< index in the finer level
    std::uint8_t present = 0;
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
        octants.present |= static_cast<std::uint8_t>(1 << octant);
    }
    return octants;
}
Octants moments_of(const MomentOctree& octree, std::size_t level, const CellOctants& of) {
    const MomentLevel& finer = octree.levels[level - 1];
    Octants octants;
    for (std::size_t o = 0; o < 8; ++o)
        if (of.present >> o & 1)
            octants[o] = cell_moments(finer.cells[of.child[o]], finer.edge_log2);
    return octants;
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

/// Nodes of a brick that have mass.
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

/// Where the nodes inside node n follow in a brick's list, those without mass left out; its end if
/// they are samples.
std::size_t first_inside(std::span<const BinarySplits> halves, std::size_t n) {
    if (n == 0) return 1;
    const auto fours = static_cast<std::size_t>(std::popcount(halves[0].present));
    if (n > fours) return halves.size();
    std::size_t first = 1 + fours;
    for (std::size_t four = 1; four < n; ++four)
        first += static_cast<std::size_t>(std::popcount(halves[four].present));
    return first;
}

/// Gains of all nodes of a brick, bottom up; what is seen is told for cells of four samples and
/// more.
void set_brick_halves(const Brick& brick, const VisibilityWeight& seen, double scale,
                      std::span<BinarySplits> with_mass) {
    std::array<BinarySplits, kBrickNodes> halves{};
    const BrickSums sums = brick_sums(brick);
    std::array<double, 9> weight{};
    for (std::size_t n = 0; n < 9; ++n)
        if (const Moments node = brick_node(brick, sums, n); node.mass > 0)
            weight[n] = scale * seen(node.mean);
    for (std::size_t n = kBrickNodes; n-- > 0;) {
        if (n < 9 ? !(weight[n] > 0) : !(sums.twos[n - 9].mass > 0)) continue;
        halves[n] = splits_of(brick_octants(brick, sums, n), weight[n < 9 ? n : (n - 1) / 8]);
        if (n < 9)
            for (std::size_t child = 8 * n + 1; child <= 8 * n + 8; ++child)
                halves[n].most = std::max(halves[n].most, halves[child].most);
    }
    std::copy_if(halves.begin(), halves.end(), with_mass.begin(),
                 [](const BinarySplits& node) { return node.present != 0; });
}

/// The best cut of node n of a brick and those inside it; `splits` of each node that may be split.
Priced priced_brick(std::span<const BinarySplits> halves, std::size_t n, double price,
                    std::array<std::uint8_t, kBrickNodes>& splits) {
    splits[n] = 0;
    if (double{from_bfloat16(halves[n].most)} <= price) return {0, 1};
    std::array<Priced, 8> octants;
    std::size_t inside = first_inside(halves, n);
    const bool samples = inside == halves.size();
    for (std::size_t o = 0; o < 8; ++o)
        if (halves[n].present >> o & 1)
            octants[o] = samples ? Priced{0, 1} : priced_brick(halves, inside++, price, splits);
    return priced(halves[n], octants, price, splits[n]);
}

/// The best cut of a tree at a price.
class PrunedTree {
  public:
    PrunedTree(const CutTree& tree, double price) : tree_(tree), price_(price) {
        const auto& levels = tree.octree.levels;
        for (std::size_t level = 0; level < levels.size(); ++level) {
            best_.emplace_back(levels[level].cells.size());
            splits_.emplace_back(levels[level].cells.size());
            vog::parallel_for(std::size_t{0}, best_[level].size(),
                              [&](std::size_t n) { best_[level][n] = best(level, n); });
        }
    }
    std::size_t count() const { return best_.empty() ? 0 : best_.back()[0].count; }
    PackedCells cells() const {
        PackedCells cut(tree_.bricks);
        cut.reserve(count());
        if (!best_.empty()) take_cell(best_.size() - 1, 0, cut);
        return cut;
    }

  private:
    Priced best(std::size_t level, std::size_t n) {
        if (const std::uint32_t b = tree_.brick_of[level][n]; b != kNoBrick) {
            std::array<std::uint8_t, kBrickNodes> splits{};
            return priced_brick(tree_.splits_of_brick(b), 0, price_, splits);
        }
        const CellOctants of =
            cell_octants(tree_.octree, level, tree_.octree.levels[level].cells[n]);
        std::array<Priced, 8> octants;
        for (std::size_t o = 0; o < 8; ++o)
            if (of.present >> o & 1) octants[o] = best_[level - 1][of.child[o]];
        return priced(tree_.cell_splits[level][n], octants, price_, splits_[level][n]);
    }
    /// place  of node n in the brick's list
    void take_brick_node(std::size_t b, const BrickSums& sums,
                         const std::array<std::uint8_t, kBrickNodes>& splits, std::size_t n,
                         std::size_t place, PackedCells& cut) const {
        const std::span<const BinarySplits> halves = tree_.splits_of_brick(b);
        const Octants octants = brick_octants(tree_.bricks[b], sums, n);
        const std::size_t inside = first_inside(halves, place);
        for_each_part(halves[place], splits[place], [&](std::uint8_t mask) {
            const std::size_t child = 8 * n + 1 + static_cast<std::size_t>(std::countr_zero(mask));
            const auto before = static_cast<std::uint8_t>(halves[place].present & (mask - 1));
            if (std::has_single_bit(mask) && child < kBrickNodes)
                take_brick_node(b, sums, splits, child,
                                inside + static_cast<std::size_t>(std::popcount(before)), cut);
            else
                cut.push_back(joined_octants(octants, mask));
        });
    }
    void take_cell(std::size_t level, std::size_t n, PackedCells& cut) const {
        if (const std::uint32_t b = tree_.brick_of[level][n]; b != kNoBrick) {
            std::array<std::uint8_t, kBrickNodes> splits{};
            priced_brick(tree_.splits_of_brick(b), 0, price_, splits);
            return take_brick_node(b, brick_sums(tree_.bricks[b]), splits, 0, 0, cut);
        }
        const CellOctants of =
            cell_octants(tree_.octree, level, tree_.octree.levels[level].cells[n]);
        const Octants octants = moments_of(tree_.octree, level, of);
        for_each_part(tree_.cell_splits[level][n], splits_[level][n], [&](std::uint8_t mask) {
            if (std::has_single_bit(mask))
                take_cell(level - 1, of.child[static_cast<std::size_t>(std::countr_zero(mask))],
                          cut);
            else
                cut.push_back(joined_octants(octants, mask));
        });
    }

    const CutTree& tree_;
    double price_;
    std::vector<std::vector<Priced>> best_;  ///< [level][cell]
    std::vector<std::vector<std::uint8_t>> splits_;
};

}  // namespace

CutTree cut_tree(const LatticeField& field, double scale) {
    CutTree tree;
    tree.octree = brick_octree(field.bricks);
    tree.bricks = field.bricks;
    find_bricks(tree);

    const VisibilityWeight seen(field);
    const auto& levels = tree.octree.levels;
    for (std::size_t level = 0; level < levels.size(); ++level) {
        const std::vector<MomentCell>& cells = levels[level].cells;
        tree.cell_splits.emplace_back(cells.size());
        vog::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t n) {
            if (cells[n].child_count == 0) return;
            const CellOctants of = cell_octants(tree.octree, level, cells[n]);
            const Vec3d mean = cell_moments(cells[n], levels[level].edge_log2).mean;
            tree.cell_splits[level][n] =
                splits_of(moments_of(tree.octree, level, of), scale * seen(mean));
        });
    }
    tree.first_splits.resize(tree.bricks.size() + 1);
    for (std::size_t b = 0; b < tree.bricks.size(); ++b)
        tree.first_splits[b + 1] = tree.first_splits[b] + node_count(tree.bricks[b]);
    tree.brick_splits.resize(tree.first_splits.back());
    vog::parallel_for(std::size_t{0}, tree.bricks.size(), [&](std::size_t b) {
        set_brick_halves(tree.bricks[b], seen, scale,
                         std::span(tree.brick_splits).subspan(tree.first_splits[b]));
    });
    for (const auto& level : tree.cell_splits)
        for (const BinarySplits& halves : level)
            tree.most_gain = std::max(tree.most_gain, halves.most);
    for (const BinarySplits& halves : tree.brick_splits)
        tree.most_gain = std::max(tree.most_gain, halves.most);
    return tree;
}

double cut_scale(double voxel_edge) { return gain_scale(voxel_edge, ColumnDepth::seen); }

std::vector<PackedCells> best_cut(std::span<const CutTree> trees, std::size_t budget) {
    double most = 0;
    for (const CutTree& tree : trees) most = std::max(most, double{from_bfloat16(tree.most_gain)});
    const double price = price_of_budget(budget, most, [&](double tried) {
        std::size_t count = 0;
        for (const CutTree& tree : trees) count += PrunedTree(tree, tried).count();
        return count;
    });
    std::vector<PackedCells> cuts;
    for (const CutTree& tree : trees) cuts.push_back(PrunedTree(tree, price).cells());
    return cuts;
}

std::size_t finest_count(const CutTree& tree) { return PrunedTree(tree, kNoPrice).count(); }

}  // namespace vog::moments
