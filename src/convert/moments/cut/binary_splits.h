// binary_splits.h: binary splits of an octree cell: across one axis, its halves across a second,
// their quarters across the third.
// Seven splits in two instead of one in eight, so that a budget can pay for a single half.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "convert/moments/cut/empty_space.h"
#include "convert/moments/gaussian_moments.h"
#include "core/bfloat16.h"

namespace vog::moments {

/// Masks of the octants on the upper side of each axis. Octants are numbered in Morton order (x the
/// most significant bit); bit o of a mask stands for octant o.
inline constexpr std::array<std::uint8_t, 3> kUpperOctants{0xF0, 0xCC, 0xAA};

/// The splits of one cell: 0 divides the cell, 1 and 2 its halves, 3 to 6 the quarters.
struct BinarySplits {
    std::array<BFloat16, 7> gain{};  ///< one for each split; 0 if a side is empty
    BFloat16 max_gain = 0;           ///< upper bound on the gains of the cell and all cells inside
    std::uint8_t occupied = 0;       ///< mask of the octants with mass
    /// Bits 0-1: axis of split 0. Bits 2 and 3: whether splits 1 and 2 are across the higher of the
    /// two axes that are left. Bit 4: the cell is one voxel or a part of one, which is not split.
    std::uint8_t axes = 0;

    static constexpr std::uint8_t kOneVoxel = 1 << 4;
    bool is_one_voxel() const { return axes & kOneVoxel; }
    /// Masks of the occupied octants on the lower and upper side of split n.
    std::array<std::uint8_t, 2> sides(int n) const;
};

/// Moments of each octant, means in index space; mass 0 if empty.
using Octants = std::array<Moments, 8>;
/// Moments of the octants in a mask other than 0.
Moments joined_octants(const Octants& octants, std::uint8_t mask);

/// Factor on the gain of splits between parts that one Gaussian would bridge (cut/empty_space.h): a budget
/// pays for them before any other, and for the best ones first where it is too small.
inline constexpr double kBridgeFactor = 1 << 20;

/// Chooses for each split the axis of largest variance, and evaluates split_gain of its two sides.
/// weight      factor on all gains
/// carried     [components of carried fields] octants whose mass is the sum of density times value
/// extents     of the octants' voxels
/// least_part  mass of the lighter side from which on kBridgeFactor counts
/// returns     max_gain is of this cell alone
BinarySplits splits_of(const Octants& octants, double weight, std::span<const Octants> carried = {},
                       const Extents& extents = {}, double least_part = 0);

/// Optimal pruning of a subtree under a Lagrange multiplier lambda, the cost of a Gaussian.
struct Subtree {
    double net_gain = 0;      ///< sum over the splits made of gain - lambda; 0 if none
    std::uint32_t count = 0;  ///< Gaussians; 0: no mass
};
/// Optimal pruning of a cell, from those of its octants.
/// split_mask  out; bit n: split n is made
Subtree pruned(const BinarySplits& splits, const std::array<Subtree, 8>& octants, double lambda,
               std::uint8_t& split_mask);

/// Calls take(mask) for each part of a cell that the splits made leave undivided. A part of one
/// octant may be divided further by the splits of that octant's own cell.
template <class Take>
void for_each_part(const BinarySplits& splits, std::uint8_t split_mask, const Take& take,
                   int n = 0) {
    const std::array<std::uint8_t, 2> side = splits.sides(n);
    const auto mask = static_cast<std::uint8_t>(side[0] | side[1]);
    if (side[0] && side[1] && !(split_mask >> n & 1)) return take(mask);
    for (int k = 0; k < 2; ++k) {
        if (!side[std::size_t(k)]) continue;
        if (n < 3)
            for_each_part(splits, split_mask, take, 2 * n + 1 + k);
        else
            take(side[std::size_t(k)]);
    }
}

}  // namespace vog::moments
