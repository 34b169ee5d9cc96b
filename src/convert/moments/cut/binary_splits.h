// binary_splits.h: a cell of the octree parted by halves: across one axis, each half across
// another, each quarter across the last. Seven splits in two where the octree has one in eight: a
// budget goes where it is worth most, not into eighths of which some were not needed.
#pragma once

#include <array>
#include <cstdint>

#include "convert/moments/gaussian_moments.h"
#include "core/bfloat16.h"

namespace vog::moments {

/// Octants on the upper side of each axis.
inline constexpr std::array<std::uint8_t, 3> kUpperOctants{0xF0, 0xCC, 0xAA};

/// The splits of one cell: 0 of the cell, 1 and 2 of its halves, 3 to 6 of their quarters. Octants
/// in Morton order (x the most significant); a set of them is a mask.
struct BinarySplits {
    std::array<BFloat16, 7> gain{};  ///< of each split; 0 where a side is empty
    BFloat16 most = 0;               ///< no less than any gain of the cell and those inside it
    std::uint8_t present = 0;        ///< octants with mass
    std::uint8_t axes = 0;  ///< of split 0 in bits 0-1; 1 and 2 across the lower of the two that
                            ///< are left, or the higher where bit 2 or 3 is set

    /// Octants of split n's lower and upper side, those without mass left out.
    std::array<std::uint8_t, 2> sides(int n) const;
};

/// Octants with their means as indices, mass 0 where there is none.
using Octants = std::array<Moments, 8>;
/// Moments of those in a mask, at least one.
Moments joined_octants(const Octants& octants, std::uint8_t mask);

/// Chooses the axes, the longest first, and tells what each split of two sides with mass is worth.
/// weight  of all gains; `most` is that of the cell alone
BinarySplits splits_of(const Octants& octants, double weight);

/// A subtree cut where it is worth most at a price for each Gaussian.
struct Priced {
    double worth = 0;         ///< gains of its splits less their price; 0 if it stays whole
    std::uint32_t count = 0;  ///< Gaussians; 0: nothing there
};
/// The best cut of a cell.
/// octants  those of its octants
/// splits   bit n: split n is worth it
Priced priced(const BinarySplits& halves, const std::array<Priced, 8>& octants, double price,
              std::uint8_t& splits);

/// Calls take(mask) for each part of a cell that stays whole, an octant's mask of one bit being
/// left to its own cell.
template <class Take>
void for_each_part(const BinarySplits& halves, std::uint8_t splits, const Take& take, int n = 0) {
    const std::array<std::uint8_t, 2> side = halves.sides(n);
    const auto mask = static_cast<std::uint8_t>(side[0] | side[1]);
    if (side[0] && side[1] && !(splits >> n & 1)) return take(mask);
    for (int k = 0; k < 2; ++k) {
        if (!side[std::size_t(k)]) continue;
        if (n < 3)
            for_each_part(halves, splits, take, 2 * n + 1 + k);
        else
            take(side[std::size_t(k)]);
    }
}

}  // namespace vog::moments
