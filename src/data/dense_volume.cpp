// dense_volume.cpp: conversion between dense arrays and sparse leaves.
#include "vog/dense.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "core/parallel.h"
#include "vog/error.h"

namespace vog {

namespace {

/// Overlap of one block with one leaf.
struct BlockInLeaf {
    Vec3i origin;                                ///< of the leaf
    std::uint32_t block = 0;                     ///< index of the block
    std::uint32_t negative = 0, not_finite = 0;  ///< number of such values
    std::uint32_t invalid = 0;                   ///< number of those that are refused
    Vec3i first_invalid{};                       ///< voxel of the first of them
    bool active = false;                         ///< some voxel is active
};

constexpr auto sort_key = [](const BlockInLeaf& o) {
    return std::tie(o.origin.x, o.origin.y, o.origin.z, o.block);
};

Vec3i leaf_of(Vec3i index) {
    return {index.x & ~(kLeafEdge - 1), index.y & ~(kLeafEdge - 1), index.z & ~(kLeafEdge - 1)};
}

/// Calls visit(index, value) for the active voxels of a block in the leaf at `origin`.
template <class Visit>
void each_active(const DenseBlock& block, Vec3i origin, const Visit& visit) {
    Vec3i lower, upper;  // range of indices into the block, upper excluded
    for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = std::max(origin[axis] - block.first[axis], 0);
        upper[axis] = std::min(origin[axis] + kLeafEdge - block.first[axis], block.size[axis]);
    }
    const auto at = [](const std::array<std::ptrdiff_t, 3>& stride, int x, int y, int z) {
        return x * stride[0] + y * stride[1] + z * stride[2];
    };
    for (int x = lower.x; x < upper.x; ++x)
        for (int y = lower.y; y < upper.y; ++y)
            for (int z = lower.z; z < upper.z; ++z) {
                const float value = block.value[at(block.stride, x, y, z)];
                // Without a mask every value but 0 counts, so that negative ones are reported.
                const bool active =
                    block.active ? block.active[at(block.active_stride, x, y, z)] : value != 0;
                if (active) visit(block.first + Vec3i{x, y, z}, value);
            }
}

void check(const DenseBlock& block, const std::string& name) {
    // Sums of two indices and origins of leaves then fit an int.
    constexpr std::int64_t kFarthest = std::int64_t{1} << 30;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t first = block.first[axis], size = block.size[axis];
        if (size < 1)
            throw Error(
                fmt::format("{}: {} voxels along axis {}, expected at least 1", name, size, axis));
        if (first < -kFarthest || first + size > kFarthest)
            throw Error(fmt::format("{}: voxels {} to {} along axis {}, expected within +-2^30",
                                    name, first, first + size - 1, axis));
    }
}

/// Overlaps of all blocks with leaves, sorted by the leaf's origin, then by block.
std::vector<BlockInLeaf> overlapped_leaves(std::span<const DenseBlock> blocks) {
    std::vector<BlockInLeaf> all;
    for (std::uint32_t n = 0; n < blocks.size(); ++n) {
        const Vec3i lower = leaf_of(blocks[n].first);
        const Vec3i upper = blocks[n].first + blocks[n].size;
        for (int x = lower.x; x < upper.x; x += kLeafEdge)
            for (int y = lower.y; y < upper.y; y += kLeafEdge)
                for (int z = lower.z; z < upper.z; z += kLeafEdge) all.push_back({{x, y, z}, n});
    }
    std::sort(all.begin(), all.end(),
              [](const BlockInLeaf& a, const BlockInLeaf& b) { return sort_key(a) < sort_key(b); });
    return all;
}

/// Sets `active` and the invalid values of an overlap.
void check_values(const DenseBlock& block, const ValueRules& rules, BlockInLeaf& overlap) {
    each_active(block, overlap.origin, [&](Vec3i index, float value) {
        const bool finite = std::isfinite(value);
        // A negative value that becomes 0 is active where a mask says so.
        overlap.active |= finite && (value > 0 || block.active);
        if (finite && value >= 0) return;
        ++(finite ? overlap.negative : overlap.not_finite);
        if (finite ? rules.clip_negative : rules.skip_nonfinite) return;
        if (overlap.invalid++ == 0) overlap.first_invalid = index;
    });
}

void require_densities(const std::vector<BlockInLeaf>& overlaps, std::span<const DenseBlock> blocks,
                       const std::string& name) {
    std::uint64_t invalid = 0;
    const BlockInLeaf* first = nullptr;
    for (const BlockInLeaf& overlap : overlaps) {
        if (overlap.invalid && !first) first = &overlap;
        invalid += overlap.invalid;
    }
    if (!first) return;
    const DenseBlock& block = blocks[first->block];
    const Vec3i at = first->first_invalid, in_block = at - block.first;
    const float value = block.value[in_block.x * block.stride[0] + in_block.y * block.stride[1] +
                                    in_block.z * block.stride[2]];
    throw Error(fmt::format(
        "{}: {} values that are no densities, the first {} at [{}, {}, {}], expected finite and >= "
        "0 (skip_nonfinite leaves such voxels out, clip_negative sets them to 0)",
        name, invalid, value, at.x, at.y, at.z));
}

}  // namespace

Volume volume_from_dense(std::span<const DenseBlock> blocks, const Affine& world_from_index,
                         const std::string& name, const ValueRules& rules, ValueNotes* notes) {
    for (const DenseBlock& block : blocks) check(block, name);

    // Only leaves with active voxels are made: an array may be mostly empty.
    std::vector<BlockInLeaf> overlaps = overlapped_leaves(blocks);
    vog::parallel_for(std::size_t{0}, overlaps.size(), [&](std::size_t n) {
        check_values(blocks[overlaps[n].block], rules, overlaps[n]);
    });
    require_densities(overlaps, blocks, name);
    if (notes)
        for (const BlockInLeaf& overlap : overlaps)
            notes->add({overlap.negative, overlap.not_finite, 0});
    std::erase_if(overlaps, [](const BlockInLeaf& overlap) { return !overlap.active; });
    if (overlaps.empty())
        throw Error(fmt::format("{}: no active voxel, expected some above 0", name));

    // One leaf for each origin; later blocks overwrite earlier ones.
    std::vector<std::size_t> first;
    for (std::size_t n = 0; n < overlaps.size(); ++n)
        if (n == 0 || overlaps[n].origin != overlaps[n - 1].origin) first.push_back(n);
    Volume volume;
    volume.name = name;
    volume.world_from_index = world_from_index;
    volume.leaves.resize(first.size());
    first.push_back(overlaps.size());
    vog::parallel_for(std::size_t{0}, volume.leaves.size(), [&](std::size_t n) {
        Leaf& leaf = volume.leaves[n];
        leaf.origin = overlaps[first[n]].origin;
        for (std::size_t r = first[n]; r < first[n + 1]; ++r)
            each_active(blocks[overlaps[r].block], leaf.origin, [&](Vec3i index, float value) {
                const bool clipped = value < 0 && blocks[overlaps[r].block].active == nullptr;
                if (!std::isfinite(value) || clipped) return;
                const Vec3i d = index - leaf.origin;
                leaf.set(leaf_offset(d.x, d.y, d.z), std::max(value, 0.0f));
            });
    });
    validate(volume);
    return volume;
}

IndexBox active_box(const Volume& volume) {
    if (volume.empty())
        throw Error((volume.name.empty() ? std::string("volume") : volume.name) +
                    ": empty, expected an active voxel");
    IndexBox box;
    bool any = false;
    const auto include = [&](Vec3i lower, Vec3i upper) {
        for (int axis = 0; axis < 3; ++axis) {
            box.lower[axis] = any ? std::min(box.lower[axis], lower[axis]) : lower[axis];
            box.upper[axis] = any ? std::max(box.upper[axis], upper[axis]) : upper[axis];
        }
        any = true;
    };
    for (const Leaf& leaf : volume.leaves) {
        Vec3i lower{kLeafEdge, kLeafEdge, kLeafEdge}, upper{-1, -1, -1};
        for (int n = 0; n < kLeafVoxels; ++n) {
            if (!leaf.active(n)) continue;
            const Vec3i at{n >> 6, n >> 3 & 7, n & 7};
            for (int axis = 0; axis < 3; ++axis) {
                lower[axis] = std::min(lower[axis], at[axis]);
                upper[axis] = std::max(upper[axis], at[axis]);
            }
        }
        if (upper.x >= 0) include(leaf.origin + lower, leaf.origin + upper);
    }
    for (const Tile& tile : volume.tiles)
        include(tile.origin, tile.origin + Vec3i{tile.edge - 1, tile.edge - 1, tile.edge - 1});
    return box;
}

void copy_dense(const Volume& volume, Vec3i first, Vec3i size, std::span<float> values) {
    const auto side = [&](int axis) { return static_cast<std::size_t>(std::max(size[axis], 0)); };
    if (values.size() != side(0) * side(1) * side(2) || values.empty())
        throw Error(fmt::format("dense array: {} values for {} x {} x {} voxels", values.size(),
                                size.x, size.y, size.z));
    std::fill(values.begin(), values.end(), 0.0f);

    // Calls put(row, voxel in the node) for each row along z of the node's overlap with the array.
    const auto each_row = [&](Vec3i origin, int edge, const auto& put) {
        Vec3i lower, upper;
        for (int axis = 0; axis < 3; ++axis) {
            const std::int64_t begin = std::int64_t{origin[axis]} - first[axis];
            lower[axis] = static_cast<int>(std::clamp<std::int64_t>(begin, 0, size[axis]));
            upper[axis] = static_cast<int>(std::clamp<std::int64_t>(begin + edge, 0, size[axis]));
        }
        if (lower.z >= upper.z) return;
        for (int x = lower.x; x < upper.x; ++x)
            for (int y = lower.y; y < upper.y; ++y) {
                const std::size_t row =
                    (static_cast<std::size_t>(x) * side(1) + static_cast<std::size_t>(y)) * side(2);
                put(values.subspan(row + static_cast<std::size_t>(lower.z),
                                   static_cast<std::size_t>(upper.z - lower.z)),
                    first + Vec3i{x, y, lower.z} - origin);
            }
    };
    vog::parallel_for(std::size_t{0}, volume.leaves.size(), [&](std::size_t n) {
        const Leaf& leaf = volume.leaves[n];
        each_row(leaf.origin, kLeafEdge, [&](std::span<float> row, Vec3i at) {
            const auto* from = leaf.value.data() + leaf_offset(at.x, at.y, at.z);
            std::copy(from, from + row.size(), row.begin());
        });
    });
    for (const Tile& tile : volume.tiles)
        each_row(tile.origin, tile.edge, [&](std::span<float> row, Vec3i) {
            std::fill(row.begin(), row.end(), tile.value);
        });
}

Affine affine_from_voxels(Vec3d voxel_size, Vec3d origin) {
    if (!finite(voxel_size) || !(voxel_size.x > 0 && voxel_size.y > 0 && voxel_size.z > 0))
        throw Error(fmt::format("voxel size {} x {} x {}, expected finite and above 0",
                                voxel_size.x, voxel_size.y, voxel_size.z));
    if (!finite(origin))
        throw Error(
            fmt::format("origin {}, {}, {}, expected finite", origin.x, origin.y, origin.z));
    return {{{Vec3d{voxel_size.x, 0, 0}, {0, voxel_size.y, 0}, {0, 0, voxel_size.z}}}, origin};
}

Affine affine_from_matrix(std::span<const double, 16> rows) {
    if (rows[12] != 0 || rows[13] != 0 || rows[14] != 0 || rows[15] != 1)
        throw Error(
            fmt::format("matrix: last row {} {} {} {}, expected 0 0 0 1 (world = M (i, j, k, 1); "
                        "for row vectors transpose it)",
                        rows[12], rows[13], rows[14], rows[15]));
    Affine map;
    for (int r = 0; r < 3; ++r) {
        const std::size_t at = static_cast<std::size_t>(4 * r);
        map.linear.row[static_cast<std::size_t>(r)] = {rows[at], rows[at + 1], rows[at + 2]};
        map.translation[r] = rows[at + 3];
    }
    const double det = determinant(map.linear);
    if (!std::isfinite(det) || det == 0 || !finite(map.translation))
        throw Error(fmt::format("matrix: determinant {}, expected an invertible, finite map", det));
    return map;
}

}  // namespace vog
