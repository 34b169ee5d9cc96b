// leaf_blocks.h: sums, counts and bounds of cubes inside a leaf, by operations on its bit mask.
//
// Word x of a leaf's mask holds slice x: bit 8 y + z is voxel (x, y, z).
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "vog/volume.h"

namespace vog::paper {

/// Mask of the square [y, y + edge) x [z, z + edge) of a slice.
/// edge  1 to 8
constexpr std::uint64_t slice_square(int y, int z, int edge) {
    const std::uint64_t row = ((std::uint64_t{1} << edge) - 1) << z;
    const std::uint64_t first_bits = 0x0101010101010101u >> (8 * (8 - edge));
    return (row * first_bits) << (8 * y);
}

/// The edge^3 voxels of a leaf whose first is (x, y, z); the whole leaf by default.
struct LeafCube {
    int x = 0, y = 0, z = 0, edge = kLeafEdge;
};

/// An index box: first voxel, and voxels along each axis.
struct VoxelBox {
    Vec3i lower, size;
};

/// Bounding box of the active voxels of a cube, relative to the leaf; size 0 if there are none.
inline VoxelBox active_box(const Leaf& leaf, LeafCube cube) {
    const std::uint64_t square = slice_square(cube.y, cube.z, cube.edge);
    std::uint64_t shadow = 0;  // union of the slices
    int first = cube.x + cube.edge, last = cube.x;
    for (int x = cube.x; x < cube.x + cube.edge; ++x) {
        const std::uint64_t bits = leaf.mask[static_cast<std::size_t>(x)] & square;
        if (!bits) continue;
        shadow |= bits;
        if (first > x) first = x;
        last = x;
    }
    if (!shadow) return {};
    std::uint64_t row = shadow | shadow >> 32;
    row |= row >> 16;
    row = (row | row >> 8) & 0xff;
    const Vec3i lower{first, std::countr_zero(shadow) >> 3, std::countr_zero(row)};
    const Vec3i upper{last, (63 - std::countl_zero(shadow)) >> 3, 63 - std::countl_zero(row)};
    return {lower, upper - lower + Vec3i{1, 1, 1}};
}

/// Active voxels in a cube.
inline int active_count(const Leaf& leaf, LeafCube cube) {
    const std::uint64_t square = slice_square(cube.y, cube.z, cube.edge);
    int count = 0;
    for (int x = cube.x; x < cube.x + cube.edge; ++x)
        count += std::popcount(leaf.mask[static_cast<std::size_t>(x)] & square);
    return count;
}

/// Sums over the aligned 2^3 blocks of a leaf; block (x, y, z) at 16 x + 4 y + z.
using BlockSums = std::array<double, 64>;

/// Inactive voxels hold 0 and need no mask.
/// power  1: sums of values; 2: sums of their squares
template <int power = 1>
BlockSums block_sums(const Leaf& leaf) {
    const auto term = [](float value) {
        const double v = value;
        return power == 1 ? v : v * v;
    };
    BlockSums sums;
    for (std::size_t x = 0; x < 4; ++x) {
        const float* slice = leaf.value.data() + 128 * x;
        for (std::size_t y = 0; y < 4; ++y) {
            // Adds the four rows along z of a block, then neighbours in z.
            const float* row = slice + 16 * y;
            std::array<double, 8> column;
            for (std::size_t z = 0; z < 8; ++z)
                column[z] =
                    (term(row[z]) + term(row[z + 8])) + (term(row[z + 64]) + term(row[z + 72]));
            for (std::size_t z = 0; z < 4; ++z)
                sums[16 * x + 4 * y + z] = column[2 * z] + column[2 * z + 1];
        }
    }
    return sums;
}

/// Sum over a cube.
/// cube  edge 2, 4 or 8, at even indices
inline double cube_sum(const BlockSums& sums, LeafCube cube) {
    const int edge = cube.edge / 2;
    double sum = 0;
    for (int x = cube.x / 2; x < cube.x / 2 + edge; ++x)
        for (int y = cube.y / 2; y < cube.y / 2 + edge; ++y)
            for (int z = cube.z / 2; z < cube.z / 2 + edge; ++z)
                sum += sums[static_cast<std::size_t>(16 * x + 4 * y + z)];
    return sum;
}

}  // namespace vog::paper
