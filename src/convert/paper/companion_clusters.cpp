// companion_clusters.cpp: the companion paper's three clusterings: by variance inside a leaf,
// across neighbouring leaves, by nodes of the tree. Source: arXiv 2504.04857, section 4; docs/
// paper_conversion.md has the choices that its text leaves open.
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "convert/paper/grouping.h"
#include "convert/paper/leaf_blocks.h"
#include "core/parallel.h"

namespace vog::paper {

namespace {

constexpr int kLowerEdge = 128;                       ///< voxels along a lower node
constexpr int kLowerLeaves = kLowerEdge / kLeafEdge;  ///< leaves along a lower node
constexpr std::array<int, 3> kDepthEdge = {4096, kLowerEdge, kLeafEdge};

double cube(double edge) { return edge * edge * edge; }

/// Origin of a node; nodes of one size are sorted by x, then y, then z.
using NodeOrigin = std::array<std::int32_t, 3>;
NodeOrigin node_origin(Vec3i voxel, int edge) {
    return {voxel.x & -edge, voxel.y & -edge, voxel.z & -edge};
}

Group tile_group(const Tile& tile) {
    const double count = cube(tile.edge);
    return {tile.origin, {tile.edge, tile.edge, tile.edge}, count * tile.value, count};
}

/// Adds the voxels of `other`; the box becomes the union.
void join(Group& group, const Group& other) {
    if (other.count == 0) return;
    if (group.count == 0) {
        group = other;
        return;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const int upper =
            std::max(group.lower[axis] + group.size[axis], other.lower[axis] + other.size[axis]);
        group.lower[axis] = std::min(group.lower[axis], other.lower[axis]);
        group.size[axis] = upper - group.lower[axis];
    }
    group.sum += other.sum;
    group.count += other.count;
}

/// Octree subdivision of one leaf by the variance of its values.
struct VarianceSplit {
    const GroupFit& fit;
    const Leaf& leaf;
    double variance;
    std::vector<FittedGaussian>& out;
    BlockSums value = block_sums(leaf), square = block_sums<2>(leaf);

    void add(LeafCube cube) const {
        const VoxelBox box = active_box(leaf, cube);
        if (box.size.x == 0) return;
        const auto accept = [&](double sum, double count) {
            add_group(fit, {leaf.origin + box.lower, box.size, sum, count}, out);
        };
        if (cube.edge == 1) {
            const int offset = leaf_offset(cube.x, cube.y, cube.z);
            accept(leaf.value[static_cast<std::size_t>(offset)], 1);
            return;
        }
        const double voxels = static_cast<double>(box.size.x * box.size.y * box.size.z);
        const double sum = cube_sum(value, cube), mean = sum / voxels;
        const double mean_square = cube_sum(square, cube) / voxels;
        // The rounding error of sums of 512 doubles is about 1e-13, relatively.
        const double rounding = 1e-12 * mean_square;
        if (mean_square - mean * mean <= variance + rounding) {
            accept(sum, active_count(leaf, cube));
            return;
        }
        const int half = cube.edge / 2;
        for (int part = 0; part < 8; ++part)
            add({cube.x + half * (part >> 2), cube.y + half * ((part >> 1) & 1),
                 cube.z + half * (part & 1), half});
    }
};

/// Grid of the 16^3 leaves of a lower node: indices of leaves not yet in a cluster, -1 elsewhere.
struct LeafTable {
    std::array<std::int64_t, kLowerLeaves * kLowerLeaves * kLowerLeaves> leaf;

    LeafTable() { leaf.fill(-1); }
    std::int64_t& at(Vec3i place) {
        return leaf[static_cast<std::size_t>((place.x * kLowerLeaves + place.y) * kLowerLeaves +
                                             place.z)];
    }
};

/// Grid position of a leaf in its lower node.
Vec3i place_in_node(Vec3i leaf_origin) {
    const auto place = [](std::int32_t origin) { return (origin & (kLowerEdge - 1)) / kLeafEdge; };
    return {place(leaf_origin.x), place(leaf_origin.y), place(leaf_origin.z)};
}

/// Whether every position of the box [lower, upper] has a leaf that `joins` accepts.
template <class Joins>
bool all_join(LeafTable& table, Vec3i lower, Vec3i upper, const Joins& joins) {
    for (int x = lower.x; x <= upper.x; ++x)
        for (int y = lower.y; y <= upper.y; ++y)
            for (int z = lower.z; z <= upper.z; ++z)
                if (const std::int64_t leaf = table.at({x, y, z}); leaf < 0 || !joins(leaf))
                    return false;
    return true;
}

/// Grows a box of leaves from `lower` in the positive directions, a layer along x, y and z in turn,
/// as long as `joins` accepts whole layers.
/// returns  position of the last leaf
template <class Joins>
Vec3i grow(LeafTable& table, Vec3i lower, const Joins& joins) {
    Vec3i upper = lower;
    for (bool grown = true; grown;) {
        grown = false;
        for (int axis = 0; axis < 3; ++axis) {
            if (upper[axis] + 1 == kLowerLeaves) continue;
            Vec3i first = lower, last = upper;
            first[axis] = last[axis] = upper[axis] + 1;
            if (!all_join(table, first, last, joins)) continue;
            upper[axis] += 1;
            grown = true;
        }
    }
    return upper;
}

/// Removes the leaves of the box [lower, upper] from the table and joins them in one group.
Group take_box(LeafTable& table, Vec3i lower, Vec3i upper, const std::vector<Group>& leaves) {
    Group group;
    for (int x = lower.x; x <= upper.x; ++x)
        for (int y = lower.y; y <= upper.y; ++y)
            for (int z = lower.z; z <= upper.z; ++z) {
                std::int64_t& leaf = table.at({x, y, z});
                join(group, leaves[static_cast<std::size_t>(leaf)]);
                leaf = -1;
            }
    return group;
}

}  // namespace

double leaf_value_variance(const Volume& volume) {
    struct Moments {
        double count = 0, sum = 0, square = 0;
    };
    const auto add = [](Moments a, const Moments& b) {
        return Moments{a.count + b.count, a.sum + b.sum, a.square + b.square};
    };
    constexpr std::size_t kGrain = 64;
    const Moments total = tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, volume.leaves.size(), kGrain), Moments{},
        [&](const tbb::blocked_range<std::size_t>& range, Moments part) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const Leaf& leaf = volume.leaves[i];
                part =
                    add(part, {static_cast<double>(leaf.active_count()),
                               cube_sum(block_sums(leaf), {}), cube_sum(block_sums<2>(leaf), {})});
            }
            return part;
        },
        add);
    if (total.count == 0) return 0;
    const double mean = total.sum / total.count;
    return std::max(0.0, total.square / total.count - mean * mean);
}

void add_variance_clusters(const GroupFit& fit, const Leaf& leaf, double variance,
                           std::vector<FittedGaussian>& out) {
    VarianceSplit{fit, leaf, variance, out}.add({});
}

std::vector<Group> leaf_groups(const Volume& volume) {
    std::vector<Group> groups(volume.leaves.size());
    vog::parallel_for(std::size_t{0}, groups.size(),
                      [&](std::size_t i) { groups[i] = leaf_group(volume.leaves[i]); });
    return groups;
}

std::vector<Group> join_neighbours(const Volume& volume, const std::vector<Group>& leaves,
                                   double similarity) {
    std::map<NodeOrigin, std::vector<std::int64_t>> nodes;
    for (std::size_t i = 0; i < leaves.size(); ++i)
        if (leaves[i].count > 0)
            nodes[node_origin(volume.leaves[i].origin, kLowerEdge)].push_back(
                static_cast<std::int64_t>(i));
    const auto mean = [&](std::int64_t i) {
        const Group& leaf = leaves[static_cast<std::size_t>(i)];
        return leaf.sum / leaf.count;
    };
    const auto place = [&](std::int64_t i) {
        return place_in_node(volume.leaves[static_cast<std::size_t>(i)].origin);
    };

    std::vector<Group> joined;
    for (const auto& [origin, members] : nodes) {
        LeafTable table;
        for (const std::int64_t i : members) table.at(place(i)) = i;
        for (const std::int64_t seed : members) {
            const Vec3i lower = place(seed);
            if (table.at(lower) < 0) continue;
            const auto joins = [&](std::int64_t i) {
                return std::abs(mean(i) - mean(seed)) <= similarity * std::max(mean(i), mean(seed));
            };
            const Vec3i upper = grow(table, lower, joins);
            joined.push_back(take_box(table, lower, upper, leaves));
        }
    }
    return joined;
}

std::vector<Group> tile_groups(const Volume& volume) {
    std::vector<Group> groups;
    for (const Tile& tile : volume.tiles) groups.push_back(tile_group(tile));
    return groups;
}

std::vector<Group> mirror_tree(const Volume& volume, const std::vector<Group>& leaves, int depth) {
    const int edge = kDepthEdge[static_cast<std::size_t>(depth) - 1];
    std::map<NodeOrigin, Group> nodes;
    for (std::size_t i = 0; i < leaves.size(); ++i)
        join(nodes[node_origin(volume.leaves[i].origin, edge)], leaves[i]);
    std::vector<Group> tiles;
    for (const Tile& tile : volume.tiles) {
        if (tile.edge < edge)
            join(nodes[node_origin(tile.origin, edge)], tile_group(tile));
        else
            tiles.push_back(tile_group(tile));
    }
    std::vector<Group> groups;
    for (const auto& [origin, group] : nodes)
        if (group.count > 0) groups.push_back(group);
    groups.insert(groups.end(), tiles.begin(), tiles.end());
    return groups;
}

}  // namespace vog::paper
