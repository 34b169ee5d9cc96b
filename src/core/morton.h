// morton.h: Morton order (Z-order), in which voxels of every aligned cube of 2^n are contiguous.
#pragma once

#include <cstdint>

#include "vog/linear.h"

namespace vog {

/// Bits of each axis in a Morton code of 63 bits.
inline constexpr int kMortonAxisBits = 21;

/// Moves bit n to bit 3n; bits from kMortonAxisBits on are dropped.
constexpr std::uint64_t spread_bits(std::uint64_t bits) {
    bits &= (1u << kMortonAxisBits) - 1;
    bits = (bits | bits << 32) & 0x001f00000000ffff;
    bits = (bits | bits << 16) & 0x001f0000ff0000ff;
    bits = (bits | bits << 8) & 0x100f00f00f00f00f;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
    return (bits | bits << 2) & 0x1249249249249249;
}

/// Interleaved bits of three coordinates in [0, 2^21), x the most significant of each three.
constexpr std::uint64_t morton_code(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
    return spread_bits(x) << 2 | spread_bits(y) << 1 | spread_bits(z);
}

/// Inverse of spread_bits: moves bit 3n to bit n; other bits are dropped.
constexpr std::uint64_t gather_bits(std::uint64_t bits) {
    bits &= 0x1249249249249249;
    bits = (bits | bits >> 2) & 0x10c30c30c30c30c3;
    bits = (bits | bits >> 4) & 0x100f00f00f00f00f;
    bits = (bits | bits >> 8) & 0x001f0000ff0000ff;
    bits = (bits | bits >> 16) & 0x001f00000000ffff;
    return (bits | bits >> 32) & ((1u << kMortonAxisBits) - 1);
}

/// Coordinates of a Morton code below 16^3.
constexpr Vec3i morton_place(int code) {
    const auto every_third = [](int bits) {
        return (bits & 1) | (bits >> 2 & 2) | (bits >> 4 & 4) | (bits >> 6 & 8);
    };
    return {every_third(code >> 2), every_third(code >> 1), every_third(code)};
}

/// Compares voxel indices of either sign in Morton order, all 32 bits of each axis.
bool morton_less(Vec3i a, Vec3i b);

/// Lower corner of the aligned cube of 2^edge_log2 voxels that holds an index.
inline Vec3i aligned(Vec3i index, int edge_log2) {
    for (int axis = 0; axis < 3; ++axis) index[axis] = index[axis] >> edge_log2 << edge_log2;
    return index;
}

}  // namespace vog
