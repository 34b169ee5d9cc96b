// voxel_lookup.cpp: hash maps of leaves and tiles by origin.
#include "data/levels/voxel_lookup.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace vog {

std::size_t VoxelLookup::Hash::operator()(Vec3i v) const {
    // Multiplicative hashing (Knuth): origins are multiples of powers of two, so the low bits of
    // the product are equal and the high bits are folded in.
    const auto mix = [](std::int32_t value, std::uint64_t factor) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(value)) * factor;
    };
    const std::uint64_t sum = mix(v.x, 0x9e3779b97f4a7c15u) ^ mix(v.y, 0xc2b2ae3d27d4eb4fu) ^
                              mix(v.z, 0x165667b19e3779f9u);
    return sum ^ sum >> 29;
}

VoxelLookup::VoxelLookup(const Volume& volume) {
    constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
    lower_ = {kMost, kMost, kMost};
    upper_ = {-kMost, -kMost, -kMost};
    const auto include = [&](Vec3i first, int edge) {
        for (int axis = 0; axis < 3; ++axis) {
            lower_[axis] = std::min(lower_[axis], first[axis]);
            upper_[axis] = std::max(upper_[axis], first[axis] + edge - 1);
        }
    };
    leaves_.reserve(volume.leaves.size());
    for (const Leaf& leaf : volume.leaves) {
        leaves_.emplace(leaf.origin, &leaf);
        include(leaf.origin, kLeafEdge);
    }
    for (const Tile& tile : volume.tiles) {
        (tile.edge == 8 ? small_ : tile.edge == 128 ? middle_ : large_).emplace(tile.origin, &tile);
        include(tile.origin, tile.edge);
    }
}

const Tile* VoxelLookup::tile_at(Vec3i index, int edge) const {
    const Map<Tile>& tiles = edge == 8 ? small_ : edge == 128 ? middle_ : large_;
    if (tiles.empty()) return nullptr;
    const auto found = tiles.find(origin(index, edge));
    return found == tiles.end() ? nullptr : found->second;
}

VoxelLookup::Block VoxelLookup::find(Vec3i index) const {
    for (int axis = 0; axis < 3; ++axis)
        if (index[axis] < lower_[axis] || index[axis] > upper_[axis]) return {};
    if (const auto leaf = leaves_.find(origin(index, kLeafEdge)); leaf != leaves_.end())
        return {leaf->second, nullptr};
    for (const int edge : {8, 128, 4096})
        if (const Tile* tile = tile_at(index, edge)) return {nullptr, tile};
    return {};
}

bool VoxelLookup::meets(Vec3i lower, Vec3i upper) const {
    for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = std::max(lower[axis], lower_[axis]);
        upper[axis] = std::min(upper[axis], upper_[axis]);
        if (lower[axis] > upper[axis]) return false;
    }
    // Searches block by block, or node by node if there are fewer nodes than blocks.
    const auto in_box = [&](Vec3i first, int edge) {
        for (int axis = 0; axis < 3; ++axis)
            if (first[axis] > upper[axis] || first[axis] + edge <= lower[axis]) return false;
        return true;
    };
    const auto active = [&](const auto& node) {
        if constexpr (requires { node.mask; })
            return meets(node, lower - node.origin, upper - node.origin);
        return true;
    };
    const auto any = [&](const auto& nodes, int edge) {
        if (nodes.empty()) return false;
        const Vec3i first = origin(lower, edge);
        double blocks = 1;
        for (int axis = 0; axis < 3; ++axis)
            blocks *= 1 + (double(upper[axis]) - first[axis]) / edge;
        if (blocks > static_cast<double>(nodes.size()))
            return std::any_of(nodes.begin(), nodes.end(), [&](const auto& node) {
                return in_box(node.first, edge) && active(*node.second);
            });
        for (std::int64_t x = first.x; x <= upper.x; x += edge)
            for (std::int64_t y = first.y; y <= upper.y; y += edge)
                for (std::int64_t z = first.z; z <= upper.z; z += edge) {
                    const auto found =
                        nodes.find(vec_cast<std::int32_t>(Vec3<std::int64_t>{x, y, z}));
                    if (found != nodes.end() && active(*found->second)) return true;
                }
        return false;
    };
    return any(leaves_, kLeafEdge) || any(small_, 8) || any(middle_, 128) || any(large_, 4096);
}

bool VoxelLookup::covers(Vec3i lower, Vec3i upper) const {
    for (int axis = 0; axis < 3; ++axis)
        if (lower[axis] < lower_[axis] || upper[axis] > upper_[axis]) return false;
    // Leaf by leaf: dense leaves are accepted without a test of each voxel.
    for (const int edge : {128, 4096})
        if (tile_at(lower, edge) && tile_at(lower, edge) == tile_at(upper, edge)) return true;
    const Vec3i first = origin(lower, kLeafEdge);
    for (std::int64_t x = first.x; x <= upper.x; x += kLeafEdge)
        for (std::int64_t y = first.y; y <= upper.y; y += kLeafEdge)
            for (std::int64_t z = first.z; z <= upper.z; z += kLeafEdge) {
                const Vec3i at = vec_cast<std::int32_t>(Vec3<std::int64_t>{x, y, z});
                const Block block = find(at);
                if (block.tile) continue;
                if (!block.leaf || !covers(*block.leaf, lower - at, upper - at)) return false;
            }
    return true;
}

std::pair<Vec3i, Vec3i> VoxelLookup::inside_leaf(Vec3i lower, Vec3i upper) {
    for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = std::max(lower[axis], 0);
        upper[axis] = std::min(upper[axis], kLeafEdge - 1);
    }
    return {lower, upper};
}

std::uint64_t VoxelLookup::slab_bits(Vec3i lower, Vec3i upper) {
    const auto run = [](int first, int last) {
        return (std::uint64_t{2} << last) - (std::uint64_t{1} << first);
    };
    // Rows of 8 bits along z, each from bit 8 y on.
    return run(lower.z, upper.z) * (run(8 * lower.y, 8 * upper.y) & 0x0101010101010101u);
}

bool VoxelLookup::covers(const Leaf& leaf, Vec3i lower, Vec3i upper) {
    const auto [first, last] = inside_leaf(lower, upper);
    const std::uint64_t bits = slab_bits(first, last);
    for (int x = first.x; x <= last.x; ++x)
        if (bits & ~leaf.mask[static_cast<std::size_t>(x)]) return false;
    return true;
}

bool VoxelLookup::meets(const Leaf& leaf, Vec3i lower, Vec3i upper) {
    const auto [first, last] = inside_leaf(lower, upper);
    const std::uint64_t bits = slab_bits(first, last);
    for (int x = first.x; x <= last.x; ++x)
        if (bits & leaf.mask[static_cast<std::size_t>(x)]) return true;
    return false;
}

}  // namespace vog
