// octree.cpp: bottom up, every node's moments from its children's.
#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "convert/moments/cells/bricks.h"
#include "convert/moments/cells/leaf_cells.h"
#include "convert/moments/cells/morton_nodes.h"
#include "convert/moments/gaussian_moments.h"
#include "core/parallel.h"
#include "vog/convert_moments.h"
#include "vog/error.h"

namespace vog {

using namespace moments;

namespace {

/// A cell and its sums in double precision, about the cell's centre: what the next level adds up.
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

/// Joins two lists of cells of one size.
std::vector<BuildCell> in_order(const std::vector<BuildCell>& a, const std::vector<BuildCell>& b) {
    std::vector<BuildCell> both(a.size() + b.size());
    std::merge(a.begin(), a.end(), b.begin(), b.end(), both.begin(),
               [](const BuildCell& left, const BuildCell& right) {
                   return morton_less(left.cell.origin, right.cell.origin);
               });
    return both;
}

/// Cells of twice the edge around `fine`, whose children follow each other.
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

/// Occupied tiles of one size.
std::vector<BuildCell> tile_cells(const Volume& volume, const std::vector<MortonNode>& nodes,
                                  int edge) {
    std::vector<BuildCell> cells;
    for (const MortonNode& node : nodes) {
        if (!node.tile || node.edge != edge || volume.tiles[node.index].value <= 0) continue;
        const double side = edge;
        const MomentSums sums =
            cube_sums(volume.tiles[node.index].value * side * side * side, side);
        cells.push_back({packed(node.origin, sums), sums});
    }
    return cells;
}

/// The finest level: the occupied cubes of `edge` voxels of every leaf.
std::vector<BuildCell> leaf_cells(const Volume& volume, const std::vector<MortonNode>& nodes,
                                  int edge) {
    std::vector<std::vector<BuildCell>> parts((nodes.size() + kNodeChunk - 1) / kNodeChunk);
    vog::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
        const std::size_t last = std::min((part + 1) * kNodeChunk, nodes.size());
        for (std::size_t n = part * kNodeChunk; n < last; ++n)
            if (!nodes[n].tile)
                for_each_cell(volume, nodes[n], edge, [&](const MomentSums& sums, Vec3d center) {
                    const double half = 0.5 * (edge - 1);
                    const Vec3i origin = vec_cast<std::int32_t>(center - Vec3d{half, half, half});
                    parts[part].push_back({packed(origin, sums), sums});
                });
    });
    std::vector<BuildCell> cells;
    for (const auto& part : parts) cells.insert(cells.end(), part.begin(), part.end());
    return cells;
}

/// Bricks of one size.
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

/// One cell around the last level's, which may be eight where they straddle an aligned plane.
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

/// Edge of a cube that holds the volume, voxels.
std::int64_t extent(const Volume& volume) {
    const Vec3d size = index_box(volume).upper - index_box(volume).lower;
    return std::llround(std::max({size.x, size.y, size.z}));
}

}  // namespace

MomentOctree moment_octree(const Volume& volume, int finest_edge) {
    validate(volume);
    if (finest_edge != 1 && finest_edge != 2 && finest_edge != 4 && finest_edge != 8)
        throw Error(fmt::format("finest cell edge {}, expected 1, 2, 4 or 8", finest_edge));
    const std::vector<MortonNode> nodes = morton_nodes(volume);
    MomentOctree octree;
    octree.world_from_index = volume.world_from_index;

    // Leaves give the finest level; larger tiles join the level of their size.
    int edge_log2 = std::countr_zero(static_cast<unsigned>(finest_edge));
    std::vector<BuildCell> cells = leaf_cells(volume, nodes, finest_edge);
    constexpr int kLargestTile = 4096;
    const std::int64_t top_edge = volume.empty() ? 1 : extent(volume);
    for (;; ++edge_log2) {
        const std::int64_t edge = std::int64_t{1} << edge_log2;
        if (edge > finest_edge) cells = parents(cells, edge_log2);
        if (edge <= kLargestTile)
            cells = in_order(cells, tile_cells(volume, nodes, static_cast<int>(edge)));
        if (!cells.empty()) octree.levels.push_back(level_of(cells, edge_log2));
        if (edge >= top_edge) break;
    }
    if (cells.size() > 1) octree.levels.push_back(root_level(cells, edge_log2 + 1));
    return octree;
}

MomentOctree moments::brick_octree(std::span<const Brick> bricks, const Affine& world_from_index,
                                   double least_top) {
    MomentOctree octree;
    octree.world_from_index = world_from_index;
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

Gaussians cell_gaussians(const MomentOctree& octree, std::size_t level,
                         std::span<const std::uint32_t> cells) {
    Gaussians model;
    model.cutoff = kMomentCutoff;
    model.method = "moments";
    resize(model, cells.size(), false);
    const MomentFrame frame = moment_frame(octree.world_from_index, false, 1);
    const MomentLevel& from = octree.levels[level];
    vog::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
        set_gaussian(model, i, cell_moments(from.cells[cells[i]], from.edge_log2), frame);
    });
    return model;
}

}  // namespace vog
