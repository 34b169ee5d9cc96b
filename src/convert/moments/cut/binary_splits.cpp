// binary_splits.cpp: sides and axes of the seven splits, their gains, and the pruning of one cell.
#include "convert/moments/cut/binary_splits.h"

#include <algorithm>
#include <limits>

#include "convert/moments/cut/split_gain.h"

namespace vog::moments {

namespace {

/// Masks of octants, [axes][split][side].
using Sides = std::array<std::array<std::array<std::uint8_t, 2>, 7>, 16>;

constexpr Sides all_sides() {
    Sides all{};
    for (std::size_t axes = 0; axes < 16; ++axes) {
        const std::size_t first = axes & 3;
        if (first == 3) continue;
        for (std::size_t n = 0; n < 7; ++n) {
            int mask = 0xFF;
            std::size_t axis = first;
            if (n > 0) {
                const std::size_t half = n < 3 ? n - 1 : (n - 3) / 2;
                const std::size_t low = first == 0 ? 1 : 0, high = first == 2 ? 1 : 2;
                const std::size_t second = axes >> (2 + half) & 1 ? high : low;
                mask &= half ? kUpperOctants[first] : ~kUpperOctants[first];
                axis = n < 3 ? second : 3 - first - second;
                if (n >= 3) mask &= (n - 3) & 1 ? kUpperOctants[second] : ~kUpperOctants[second];
            }
            all[axes][n] = {static_cast<std::uint8_t>(mask & ~kUpperOctants[axis]),
                            static_cast<std::uint8_t>(mask & kUpperOctants[axis])};
        }
    }
    return all;
}
constexpr Sides kSides = all_sides();

}  // namespace

std::array<std::uint8_t, 2> BinarySplits::sides(int n) const {
    const auto [lower, upper] = kSides[axes & 15][std::size_t(n)];
    return {static_cast<std::uint8_t>(lower & occupied),
            static_cast<std::uint8_t>(upper & occupied)};
}

Moments joined_octants(const Octants& octants, std::uint8_t mask) {
    std::array<Moments, 8> parts;
    std::size_t count = 0;
    for (std::size_t o = 0; o < 8; ++o)
        if (mask >> o & 1) parts[count++] = octants[o];
    return count == 1 ? parts[0] : joined_moments(std::span(parts).first(count));
}

namespace {

/// Axis (0 x, 1 y, 2 z) of largest variance among those in `allowed` that divide the octants of
/// `mask` into two occupied sides; the lowest in `allowed` if none does.
/// allowed  bit n: axis n
int longest_axis(const Moments& moments, std::uint8_t mask, int allowed) {
    constexpr std::array<std::size_t, 3> kDiagonal{0, 3, 5};
    int longest = std::countr_zero(unsigned(allowed));
    double max_gain = -1;
    for (int axis = 0; axis < 3; ++axis) {
        const std::uint8_t upper = kUpperOctants[std::size_t(axis)];
        if (!(allowed >> axis & 1) || !(mask & upper) || !(mask & ~upper)) continue;
        const double variance = moments.covariance[kDiagonal[std::size_t(axis)]];
        if (variance > max_gain) max_gain = variance, longest = axis;
    }
    return longest;
}

double mass_of(const Octants& octants, std::uint8_t mask) {
    double mass = 0;
    for (std::size_t o = 0; o < 8; ++o)
        if (mask >> o & 1) mass += octants[o].mass;
    return mass;
}

/// Variance of carried fields between two sides of a cell: the variance inside the cell less that inside the sides.
double variance_between(const Octants& octants, std::span<const Octants> carried,
                        const std::array<std::uint8_t, 2>& side) {
    const double a = mass_of(octants, side[0]), b = mass_of(octants, side[1]);
    double squares = 0;
    for (const Octants& values : carried) {
        const double difference = mass_of(values, side[0]) / a - mass_of(values, side[1]) / b;
        squares += difference * difference;
    }
    return a / (a + b) * (b / (a + b)) * squares;
}

}  // namespace

BinarySplits splits_of(const Octants& octants, double weight, std::span<const Octants> carried,
                       const Extents& extents, double least_part) {
    BinarySplits splits;
    for (std::size_t o = 0; o < 8; ++o)
        if (octants[o].mass > 0) splits.occupied |= static_cast<std::uint8_t>(1 << o);
    float max_gain = 0;
    for (int n = 0; n < 7; ++n) {
        std::array<std::uint8_t, 2> side = splits.sides(n);
        const auto mask = static_cast<std::uint8_t>(side[0] | side[1]);
        if (std::popcount(mask) < 2) continue;
        const Moments whole = joined_octants(octants, mask);
        if (n == 0) {
            splits.axes = static_cast<std::uint8_t>(longest_axis(whole, mask, 7));
        } else if (n < 3) {
            const int allowed = 7 & ~(1 << (splits.axes & 3));
            if (longest_axis(whole, mask, allowed) != std::countr_zero(unsigned(allowed)))
                splits.axes |= static_cast<std::uint8_t>(2 << n);
        }
        side = splits.sides(n);
        if (!side[0] || !side[1]) continue;
        const Moments lower = joined_octants(octants, side[0]),
                      upper = joined_octants(octants, side[1]);
        double gain = weight * split_gain(whole, lower, upper, DepthPower::quarter,
                                          variance_between(octants, carried, side));
        if (std::min(lower.mass, upper.mass) >= least_part &&
            bridges(whole, joined_extents(extents, side[0]), joined_extents(extents, side[1])))
            gain *= kBridgeFactor;
        const auto finite = static_cast<float>(
            std::min(gain, static_cast<double>(std::numeric_limits<float>::max())));
        splits.gain[std::size_t(n)] = to_bfloat16(finite);
        max_gain = std::max(max_gain, finite);
    }
    splits.max_gain = to_bfloat16(max_gain);  // rounded towards zero, as the gains are
    return splits;
}

namespace {

/// Optimal pruning of two sides and the split between them.
Subtree pruned_split(const Subtree& a, const Subtree& b, double gain, double lambda, bool& split) {
    split = false;
    if (a.count == 0) return b;
    if (b.count == 0) return a;
    const double net = gain - lambda + a.net_gain + b.net_gain;
    split = net > 0;
    return split ? Subtree{net, a.count + b.count} : Subtree{0, 1};
}

}  // namespace

Subtree pruned(const BinarySplits& splits, const std::array<Subtree, 8>& octants, double lambda,
               std::uint8_t& split_mask) {
    split_mask = 0;
    std::array<Subtree, 7> best;
    for (int n = 6; n >= 0; --n) {
        std::array<Subtree, 2> side;
        if (n < 3) {
            side = {best[std::size_t(2 * n + 1)], best[std::size_t(2 * n + 2)]};
        } else {
            const std::array<std::uint8_t, 2> masks = splits.sides(n);
            for (std::size_t k = 0; k < 2; ++k)
                if (masks[k]) side[k] = octants[std::size_t(std::countr_zero(masks[k]))];
        }
        bool split;
        best[std::size_t(n)] = pruned_split(
            side[0], side[1], double{from_bfloat16(splits.gain[std::size_t(n)])}, lambda, split);
        split_mask |= std::uint8_t(split << n);
    }
    return best[0];
}

}  // namespace vog::moments
