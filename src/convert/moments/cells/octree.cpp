// octree.cpp: the levels of the moment octree, each summed from the one below.
#include "convert/moments/cells/octree.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/parallel.h"

namespace vog::moments {

namespace {

/// A cell with its sums about its own centre in double precision, from which its parent is summed.
struct BuildCell {
    MomentCell cell;
    MomentSums sums;
};

MomentCell packed(Vec3i origin, const MomentSums& sums) {
    const Moments moments = moments_of(sums);
    MomentCell cell;
    cell.origin = origin;
    cell.mass = static_cast<float>(moments.mass);
    cell.mean = vec_cast<float>(moments.mean);
    for (std::size_t n = 0; n < 6; ++n)
        cell.covariance[n] = static_cast<float>(moments.covariance[n]);
    return cell;
}

/// Merges two lists of cells of one size in Morton order.
std::vector<BuildCell> in_order(const std::vector<BuildCell>& a, const std::vector<BuildCell>& b) {
    std::vector<BuildCell> both(a.size() + b.size());
    std::merge(a.begin(), a.end(), b.begin(), b.end(), both.begin(),
               [](const BuildCell& left, const BuildCell& right) {
                   return morton_less(left.cell.origin, right.cell.origin);
               });
    return both;
}

/// Parents of `fine`, cells of 2^edge_log2 voxels; the children of each are contiguous in `fine`.
std::vector<BuildCell> parents(const std::vector<BuildCell>& fine, int edge_log2) {
    std::vector<BuildCell> merged;
    const double quarter = 0.25 * static_cast<double>(std::int64_t{1} << edge_log2);
    for (std::size_t first = 0; first < fine.size();) {
        const Vec3i origin = aligned(fine[first].cell.origin, edge_log2);
        std::size_t last = first;
        MomentSums sums;
        for (; last < fine.size() && aligned(fine[last].cell.origin, edge_log2) == origin; ++last) {
            const Vec3i child = fine[last].cell.origin;
            add_shifted(
                sums, fine[last].sums,
                {child.x == origin.x ? -quarter : quarter, child.y == origin.y ? -quarter : quarter,
                 child.z == origin.z ? -quarter : quarter});
        }
        BuildCell parent{packed(origin, sums), sums};
        parent.cell.first_child = static_cast<std::uint32_t>(first);
        parent.cell.child_count = static_cast<std::uint32_t>(last - first);
        merged.push_back(parent);
        first = last;
    }
    return merged;
}

/// One cell for each brick of this spacing, in Morton order.
std::vector<BuildCell> brick_cells(std::span<const Brick> bricks, double spacing) {
    std::vector<const Brick*> some;
    for (const Brick& brick : bricks)
        if (brick.spacing == spacing) some.push_back(&brick);
    std::vector<BuildCell> cells(some.size());
    vog::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t n) {
        const MomentSums sums = brick_sums(*some[n]).whole;
        cells[n] = {packed(some[n]->origin, sums), sums};
    });
    return cells;
}

MomentLevel level_of(const std::vector<BuildCell>& cells, int edge_log2) {
    MomentLevel level;
    level.edge_log2 = edge_log2;
    level.cells.reserve(cells.size());
    for (const BuildCell& built : cells) level.cells.push_back(built.cell);
    return level;
}

/// A root for up to eight cells that meet at an aligned plane, such as index 0, and so have no
/// common parent however large the cells grow.
MomentLevel root_level(const std::vector<BuildCell>& top, int edge_log2) {
    const auto edge = static_cast<double>(std::int64_t{1} << edge_log2);
    const Vec3i origin = top.front().cell.origin;
    MomentSums sums;
    for (const BuildCell& built : top)
        add_shifted(sums, built.sums,
                    cube_center(built.cell.origin, 0.5 * edge) - cube_center(origin, edge));
    MomentLevel level;
    level.edge_log2 = edge_log2;
    level.cells = {packed(origin, sums)};
    level.cells[0].child_count = static_cast<std::uint32_t>(top.size());
    return level;
}

}  // namespace

MomentOctree brick_octree(std::span<const Brick> bricks, double least_top) {
    MomentOctree octree;
    double largest = 1;
    Box box;
    for (const Brick& brick : bricks) {
        const double reach = kLeafEdge * brick.spacing;
        largest = std::max(largest, brick.spacing);
        box.include(vec_cast<double>(brick.origin));
        box.include(vec_cast<double>(brick.origin) + Vec3d{reach, reach, reach});
    }
    const Vec3d size = bricks.empty() ? Vec3d{} : box.upper - box.lower;
    const double top_edge = std::max({size.x, size.y, size.z, least_top});
    std::vector<BuildCell> cells;
    int edge_log2 = std::countr_zero(static_cast<unsigned>(kLeafEdge));
    for (;; ++edge_log2) {
        const double edge = std::ldexp(1.0, edge_log2), spacing = edge / kLeafEdge;
        cells = parents(cells, edge_log2);
        if (spacing <= largest) cells = in_order(cells, brick_cells(bricks, spacing));
        if (!cells.empty()) octree.levels.push_back(level_of(cells, edge_log2));
        if (edge >= top_edge) break;
    }
    if (cells.size() > 1) octree.levels.push_back(root_level(cells, edge_log2 + 1));
    return octree;
}

Moments cell_moments(const MomentCell& cell, int edge_log2) {
    Moments moments;
    moments.mass = cell.mass;
    moments.mean =
        vec_cast<double>(cell.mean) + cube_center(cell.origin, std::ldexp(1.0, edge_log2));
    for (std::size_t n = 0; n < 6; ++n) moments.covariance[n] = cell.covariance[n];
    return moments;
}

}  // namespace vog::moments
