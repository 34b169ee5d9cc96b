// leaf_grouping.cpp: the paper's four divisions of one leaf (section 3.3), on bit masks.
#include <array>
#include <bit>
#include <cstdint>

#include "convert/paper/grouping.h"
#include "convert/paper/leaf_blocks.h"

namespace vog::paper {

namespace {

using Mask = std::array<std::uint64_t, 8>;

constexpr std::uint64_t kEvenYEvenZ = 0x0055005500550055u;
constexpr std::uint64_t kLastY = 0xff00000000000000u;
constexpr std::uint64_t kLastZ = 0x8080808080808080u;

/// Index of the voxel at an offset of the leaf.
Vec3i voxel_index(const Leaf& leaf, int offset) {
    return leaf.origin + Vec3i{offset >> 6, (offset >> 3) & 7, offset & 7};
}

double value_at(const Leaf& leaf, int offset) {
    return static_cast<double>(leaf.value[static_cast<std::size_t>(offset)]);
}

/// Appends the aligned 2^3 blocks whose voxels are all active.
/// returns  mask of the other active voxels
Mask add_full_blocks(const GroupFit& fit, const Leaf& leaf, std::vector<FittedGaussian>& out) {
    Mask left = leaf.mask;
    const BlockSums sums = block_sums(leaf);
    for (int x = 0; x < kLeafEdge; x += 2) {
        std::uint64_t& near = left[static_cast<std::size_t>(x)];
        std::uint64_t& far = left[static_cast<std::size_t>(x) + 1];
        // Conjunction of the eight voxels of a block, in the bit of its first.
        std::uint64_t full = near & far;
        full &= full >> 1;
        full &= full >> 8;
        full &= kEvenYEvenZ;
        std::uint64_t covered = full | full << 1;
        covered |= covered << 8;
        near &= ~covered;
        far &= ~covered;
        for (; full; full &= full - 1) {
            const int bit = std::countr_zero(full), y = bit >> 3, z = bit & 7;
            const double sum = sums[static_cast<std::size_t>(8 * x + 2 * y + z / 2)];
            add_group(fit, {leaf.origin + Vec3i{x, y, z}, {2, 2, 2}, sum, 8}, out);
        }
    }
    return left;
}

}  // namespace

void add_dense_blocks(const GroupFit& fit, const Leaf& leaf, int edge,
                      std::vector<FittedGaussian>& out) {
    const BlockSums sums = block_sums(leaf);
    const double count = edge * edge * edge;
    for (int x = 0; x < kLeafEdge; x += edge)
        for (int y = 0; y < kLeafEdge; y += edge)
            for (int z = 0; z < kLeafEdge; z += edge)
                add_group(fit,
                          {leaf.origin + Vec3i{x, y, z},
                           {edge, edge, edge},
                           cube_sum(sums, {x, y, z, edge}),
                           count},
                          out);
}

void add_smart_groups(const GroupFit& fit, const Leaf& leaf, std::vector<FittedGaussian>& out) {
    Mask left = add_full_blocks(fit, leaf, out);
    const auto add_pair = [&](int offset, int step, Vec3i size) {
        const double sum = value_at(leaf, offset) + value_at(leaf, offset + step);
        add_group(fit, {voxel_index(leaf, offset), size, sum, 2}, out);
    };
    // Memory order: slice by slice, lowest bit first. Voxels before the current one are grouped
    // already, so that only its three later neighbours can join it.
    for (int x = 0; x < kLeafEdge; ++x) {
        std::uint64_t here = left[static_cast<std::size_t>(x)];
        std::uint64_t none = 0;
        std::uint64_t& next = x + 1 < kLeafEdge ? left[static_cast<std::size_t>(x) + 1] : none;
        while (here) {
            const std::uint64_t voxel = here & -here;
            const int offset = 64 * x + std::countr_zero(voxel);
            here ^= voxel;
            const std::uint64_t along_y = here & ((voxel & ~kLastY) << 8);
            const std::uint64_t along_z = here & ((voxel & ~kLastZ) << 1);
            if (next & voxel) {
                next ^= voxel;
                add_pair(offset, 64, {2, 1, 1});
            } else if (along_y) {
                here ^= along_y;
                add_pair(offset, 8, {1, 2, 1});
            } else if (along_z) {
                here ^= along_z;
                add_pair(offset, 1, {1, 1, 2});
            } else {
                add_group(fit, {voxel_index(leaf, offset), {1, 1, 1}, value_at(leaf, offset), 1},
                          out);
            }
        }
    }
}

void add_strict_blocks(const GroupFit& fit, const Leaf& leaf, std::vector<FittedGaussian>& out) {
    const Mask left = add_full_blocks(fit, leaf, out);
    for (int x = 0; x < kLeafEdge; ++x)
        for (std::uint64_t bits = left[static_cast<std::size_t>(x)]; bits; bits &= bits - 1) {
            const int offset = 64 * x + std::countr_zero(bits);
            add_group(fit, {voxel_index(leaf, offset), {1, 1, 1}, value_at(leaf, offset), 1}, out);
        }
}

Group leaf_group(const Leaf& leaf) {
    const VoxelBox box = active_box(leaf, {});
    return {leaf.origin + box.lower, box.size, cube_sum(block_sums(leaf), {}),
            static_cast<double>(leaf.active_count())};
}

void add_single(const GroupFit& fit, const Leaf& leaf, std::vector<FittedGaussian>& out) {
    const Group group = leaf_group(leaf);
    if (group.count > 0) add_group(fit, group, out);
}

}  // namespace vog::paper
