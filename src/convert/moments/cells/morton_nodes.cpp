// morton_nodes.cpp: leaves and tiles sorted by the Morton code of their origins.
#include "convert/moments/cells/morton_nodes.h"

#include <tbb/parallel_sort.h>

#include <bit>

#include "core/parallel.h"

namespace vog::moments {

std::vector<MortonNode> morton_nodes(const Volume& volume) {
    std::vector<MortonNode> nodes;
    nodes.reserve(volume.leaves.size() + volume.tiles.size());
    for (std::size_t n = 0; n < volume.leaves.size(); ++n) {
        check_interrupt();
        nodes.push_back({volume.leaves[n].origin, kLeafEdge, static_cast<std::uint32_t>(n), false});
    }
    for (std::size_t n = 0; n < volume.tiles.size(); ++n)
        nodes.push_back(
            {volume.tiles[n].origin, volume.tiles[n].edge, static_cast<std::uint32_t>(n), true});
    tbb::parallel_sort(nodes.begin(), nodes.end(), [](const MortonNode& a, const MortonNode& b) {
        return morton_less(a.origin, b.origin);
    });
    return nodes;
}

LeafNeighbours::LeafNeighbours(std::span<const MortonNode> nodes, std::optional<IndexBox> period)
    : nodes_(nodes), period_(period) {
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const Vec3i origin = aligned(nodes[n].origin, kBlockLog2);
        if (blocks_.empty() || !(blocks_.back().origin == origin))
            blocks_.push_back({origin, static_cast<std::uint32_t>(n), 0});
        const Vec3i at = nodes[n].origin - origin;
        const auto place = [](int voxels) {
            return static_cast<std::uint64_t>(voxels / kLeafEdge);
        };
        blocks_.back().leaves |= std::uint64_t{1}
                                 << morton_code(place(at.x), place(at.y), place(at.z));
    }
    slots_.resize(std::bit_ceil(2 * blocks_.size() + 1));
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        std::size_t slot = slot_of(blocks_[b].origin);
        while (slots_[slot] != 0) slot = (slot + 1) % slots_.size();
        slots_[slot] = static_cast<std::uint32_t>(b + 1);
    }
}

std::size_t LeafNeighbours::slot_of(Vec3i origin) const {
    // Multiplicative hashing (Knuth): the upper bits of products by odd numbers near 2^64 / golden ratio.
    std::uint64_t hash = 0;
    for (const int at : {origin.x, origin.y, origin.z})
        hash = (hash ^ static_cast<std::uint32_t>(at >> kBlockLog2)) * 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(hash >> 32) % slots_.size();
}

const LeafNeighbours::Block* LeafNeighbours::block_at(Vec3i origin) const {
    for (std::size_t slot = slot_of(origin); slots_[slot] != 0; slot = (slot + 1) % slots_.size())
        if (const Block& block = blocks_[slots_[slot] - 1]; block.origin == origin) return &block;
    return nullptr;
}

Vec3i LeafNeighbours::neighbour(Vec3i origin, Vec3i side) const {
    Vec3i at = origin + kLeafEdge * side;
    if (!period_) return at;
    for (int axis = 0; axis < 3; ++axis) {
        const int lower = period_->lower[axis], end = period_->upper[axis] + 1;
        if (origin[axis] == lower && side[axis] < 0) at[axis] = end - kLeafEdge;
        if (origin[axis] == end - kLeafEdge && side[axis] > 0) at[axis] = lower;
    }
    return at;
}

LeafNeighbours::Around LeafNeighbours::around(Vec3i origin) const {
    Around found{};
    const Block* block = nullptr;
    Vec3i searched;
    bool any = false;  // whether `block` is that at `searched`
    for (int n = 0; n < 27; ++n) {
        const Vec3i at = neighbour(origin, {n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1});
        const Vec3i corner = aligned(at, kBlockLog2);
        if (!any || !(corner == searched)) block = block_at(corner), searched = corner, any = true;
        if (!block) continue;
        const Vec3i in = at - corner;
        const auto place = [](int voxels) {
            return static_cast<std::uint64_t>(voxels / kLeafEdge);
        };
        const std::uint64_t bit = std::uint64_t{1}
                                  << morton_code(place(in.x), place(in.y), place(in.z));
        if (!(block->leaves & bit)) continue;
        const auto before = static_cast<std::size_t>(std::popcount(block->leaves & (bit - 1)));
        const MortonNode& node = nodes_[block->first + before];
        if (node.edge == kLeafEdge) found[static_cast<std::size_t>(n)] = &node;
    }
    return found;
}

}  // namespace vog::moments
