// volume_partition.cpp: division of a volume into runs of leaves and tiles in Morton order.
#include "data/volume_partition.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <numeric>

#include "core/morton.h"
#include "vog/error.h"

namespace vog {

const Collective& collective_or_single(const Collective* collective) {
    static const Collective single;
    return collective ? *collective : single;
}

void validate(const VolumePart& part) {
    if (part.count < 1 || part.index < 0 || part.index >= part.count)
        throw Error(fmt::format(
            "part {} of {}, expected an index from 0 to one less than the number of parts",
            part.index, part.count));
    if (part.align_voxels < kLeafEdge ||
        !std::has_single_bit(static_cast<unsigned>(part.align_voxels)))
        throw Error(fmt::format("parts aligned to {} voxels, expected a power of two, at least {}",
                                part.align_voxels, kLeafEdge));
}

namespace {

/// Position in `order` of the first node of an aligned cube with at least `voxels` before it.
std::size_t run_begin(std::span<const PartNode> nodes, std::span<const std::uint32_t> order,
                      int edge_log2, std::uint64_t voxels) {
    std::uint64_t before = 0;
    for (std::size_t n = 0; n < order.size(); before += nodes[order[n++]].voxels) {
        const bool begins_cube = n == 0 || aligned(nodes[order[n]].origin, edge_log2) !=
                                               aligned(nodes[order[n - 1]].origin, edge_log2);
        if (begins_cube && before >= voxels) return n;
    }
    return order.size();
}

}  // namespace

std::vector<std::uint32_t> nodes_of(std::span<const PartNode> nodes, const VolumePart& part) {
    validate(part);
    std::vector<std::uint32_t> order(nodes.size());
    std::iota(order.begin(), order.end(), 0u);
    if (part.whole()) return order;
    std::ranges::sort(order, morton_less, [&](std::uint32_t n) { return nodes[n].origin; });
    std::uint64_t total = 0;
    for (const PartNode& node : nodes) total += node.voxels;
    const auto begin = [&](int index) {
        if (index == part.count) return order.size();
        const auto n = static_cast<std::uint64_t>(index);
        const auto count = static_cast<std::uint64_t>(part.count);
        return run_begin(nodes, order, std::countr_zero(static_cast<unsigned>(part.align_voxels)),
                         total / count * n + total % count * n / count);
    };
    const std::size_t first = begin(part.index), last = begin(part.index + 1);
    std::vector<std::uint32_t> run(order.begin() + static_cast<std::ptrdiff_t>(first),
                                   order.begin() + static_cast<std::ptrdiff_t>(last));
    std::ranges::sort(run);
    return run;
}

Volume nodes_where(const Volume& volume, const NodeChoice& selected) {
    Volume some;
    some.world_from_index = volume.world_from_index;
    some.name = volume.name;
    some.source = volume.source;
    some.units = volume.units;
    some.background = volume.background, some.is_image = volume.is_image;
    for (const Leaf& leaf : volume.leaves)
        if (selected(leaf.origin, kLeafEdge)) some.leaves.push_back(leaf);
    for (const Tile& tile : volume.tiles)
        if (selected(tile.origin, tile.edge)) some.tiles.push_back(tile);
    return some;
}

Volume part_of(const Volume& volume, const VolumePart& part) {
    std::vector<PartNode> nodes;
    for (const Leaf& leaf : volume.leaves)
        nodes.push_back({leaf.origin, static_cast<std::uint32_t>(leaf.active_count())});
    for (const Tile& tile : volume.tiles) nodes.push_back({tile.origin, kLeafVoxels});

    Volume some;
    some.world_from_index = volume.world_from_index;
    some.name = volume.name;
    some.source = volume.source;
    some.units = volume.units;
    some.background = volume.background, some.is_image = volume.is_image;
    for (const std::uint32_t n : nodes_of(nodes, part)) {
        if (n < volume.leaves.size())
            some.leaves.push_back(volume.leaves[n]);
        else
            some.tiles.push_back(volume.tiles[n - volume.leaves.size()]);
    }
    return some;
}

}  // namespace vog
