// binary_splits_test.cpp: split gains against numerical integrals, prunings of a cell against all
// 128 sets of splits, moments of cuts.
#include "convert/moments/cut/binary_splits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "convert/moments/cut/optimal_cut.h"
#include "convert/moments/cut/split_gain.h"
#include "support/moment_volumes.h"

namespace vog {

using namespace moments;
namespace {

using Random = std::mt19937;

double uniform(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

/// Random octants of a cell of edge 8.
/// share  probability of mass
Octants random_octants(Random& random, double share) {
    Octants octants;
    for (std::size_t o = 0; o < 8; ++o) {
        if (uniform(random, 0, 1) > share) continue;
        octants[o].mass = std::exp(uniform(random, -3, 3));
        for (int axis = 0; axis < 3; ++axis)
            octants[o].mean[axis] = (o >> (2 - axis) & 1 ? 6 : 2) + uniform(random, -1, 1);
        octants[o].covariance = {
            uniform(random, 0.5, 2), uniform(random, -0.2, 0.2), 0.1,
            uniform(random, 0.5, 2), uniform(random, -0.2, 0.2), uniform(random, 0.5, 2)};
    }
    return octants;
}

double density(const Moments& m, Vec3d at) {
    const auto& c = m.covariance;
    const Mat3 covariance{{Vec3d{c[0], c[1], c[2]}, {c[1], c[3], c[4]}, {c[2], c[4], c[5]}}};
    const Vec3d d = at - m.mean;
    return m.mass * std::exp(-0.5 * dot(d, inverse(covariance) * d)) /
           std::sqrt(std::pow(2 * std::numbers::pi, 3) * determinant(covariance));
}

TEST(binary_splits, a_gain_is_the_integral_of_the_squared_difference) {
    Random random(7);
    const Octants octants = random_octants(random, 1);
    const Moments a = joined_octants(octants, 0x0F), b = joined_octants(octants, 0xF0),
                  whole = joined_octants(octants, 0xFF);
    // Sums over a lattice equal the integral up to exp(-(2 pi sigma / h)^2 / 2).
    constexpr double kStep = 0.5;
    double squares = 0, norm = 0;
    for (double x = -12; x < 20; x += kStep)
        for (double y = -12; y < 20; y += kStep)
            for (double z = -12; z < 20; z += kStep) {
                const Vec3d at{x, y, z};
                const double d = density(whole, at) - density(a, at) - density(b, at);
                squares += d * d * kStep * kStep * kStep;
                norm += density(whole, at) * density(whole, at) * kStep * kStep * kStep;
            }
    const auto& c = whole.covariance;
    const double edge = 2 * std::sqrt(c[0] + c[3] + c[5]), column = whole.mass / (edge * edge);
    const double base = squares * std::pow(edge, 2.5);
    EXPECT_NEAR(
        split_gain(whole, a, b, DepthPower::three_quarters) / (base / std::pow(column, 0.75)), 1,
        1e-6);
    EXPECT_NEAR(split_gain(whole, a, b, DepthPower::quarter) / (base / std::pow(column, 0.25)), 1,
                1e-6);
    // Values +s and -s at equal masses, s^2 = 0.3: squares of density times value add 0.3 of the Gaussian's own.
    const double carried = (squares + 0.3 * norm) * std::pow(edge, 2.5) / std::pow(column, 0.25);
    EXPECT_NEAR(split_gain(whole, a, b, DepthPower::quarter, 0.3) / carried, 1, 1e-6);
}

TEST(binary_splits, a_gain_has_the_variance_between_its_sides) {
    Random random(8);
    const Octants octants = random_octants(random, 1);
    // A value that differs between the halves across x only: 2 below, 5 above, in units of its deviation.
    std::vector<Octants> carried{octants};
    for (std::size_t o = 0; o < 8; ++o) carried[0][o].mass *= o < 4 ? 2 : 5;
    const BinarySplits plain = splits_of(octants, 1), follows = splits_of(octants, 1, carried);
    for (int n = 0; n < 7; ++n) {
        const std::array<std::uint8_t, 2> side = plain.sides(n);
        const Moments a = joined_octants(octants, side[0]), b = joined_octants(octants, side[1]),
                      whole = joined_octants(octants, side[0] | side[1]);
        const auto value = [&](const Moments& part, std::uint8_t mask) {
            return joined_octants(carried[0], mask).mass / part.mass;
        };
        const double difference = value(a, side[0]) - value(b, side[1]),
                     share = a.mass / whole.mass,
                     variance = share * (1 - share) * difference * difference,
                     gain = split_gain(whole, a, b, DepthPower::quarter, variance);
        constexpr double kTruncated = 1 / 128.0;  // bfloat16, rounded towards zero
        EXPECT_NEAR(from_bfloat16(follows.gain[std::size_t(n)]) / gain, 1, kTruncated) << n;
        EXPECT_GE(follows.gain[std::size_t(n)], plain.gain[std::size_t(n)]) << n;
    }
}

TEST(binary_splits, all_splits_together_separate_the_octants) {
    Random random(11);
    for (int tries = 0; tries < 200; ++tries) {
        const Octants octants = random_octants(random, 0.7);
        const BinarySplits splits = splits_of(octants, 1);
        int parts = 0, all = 0;
        for_each_part(splits, 0x7F, [&](std::uint8_t mask) {
            EXPECT_TRUE(std::has_single_bit(mask));
            EXPECT_FALSE(all & mask) << "no octant twice";
            all |= mask;
            ++parts;
        });
        EXPECT_EQ(all, splits.occupied);
        EXPECT_EQ(parts, std::popcount(splits.occupied));
        for (int n = 0; n < 7; ++n) {
            const auto [lower, upper] = splits.sides(n);
            EXPECT_FALSE(lower & upper);
            EXPECT_EQ(splits.gain[std::size_t(n)] > 0, lower && upper);
            EXPECT_LE(splits.gain[std::size_t(n)], splits.max_gain);
        }
    }
}

TEST(binary_splits, a_long_cell_is_split_across_its_length) {
    for (int axis = 0; axis < 3; ++axis) {
        Octants octants;
        for (std::size_t o = 0; o < 8; ++o) {
            octants[o] = {1, {}, {0.1, 0, 0, 0.1, 0, 0.1}};
            for (int k = 0; k < 3; ++k)
                octants[o].mean[k] = o >> (2 - k) & 1 ? (k == axis ? 3 : 1) : 0;
        }
        const BinarySplits splits = splits_of(octants, 1);
        EXPECT_EQ(splits.axes & 3, axis);
        EXPECT_EQ(splits.sides(0)[1], kUpperOctants[std::size_t(axis)]);
        EXPECT_GT(splits.gain[0], splits.gain[1]);
    }
}

TEST(binary_splits, no_other_set_of_splits_has_a_larger_net_gain) {
    Random random(5);
    for (int tries = 0; tries < 100; ++tries) {
        const BinarySplits splits = splits_of(random_octants(random, tries % 2 ? 0.6 : 1), 1);
        if (!splits.occupied) continue;
        std::array<Subtree, 8> octants;
        for (std::size_t o = 0; o < 8; ++o)
            if (splits.occupied >> o & 1)
                octants[o] = {uniform(random, 0, 1) < 0.5 ? 0.0 : 0.02, 1};
        const double lambda = std::exp(uniform(random, -6, 2));
        std::uint8_t split_mask = 0;
        const Subtree best = pruned(splits, octants, lambda, split_mask);

        // Net gain of a set of splits. Splits below one that is not made do not count.
        const auto net_gain_of = [&](int set) {
            const std::function<double(int)> net_gain = [&](int n) -> double {
                const auto side = splits.sides(n);
                const auto below = [&](std::size_t k) {
                    if (!side[k]) return 0.0;
                    return n < 3 ? net_gain(2 * n + 1 + int(k))
                                 : octants[std::size_t(std::countr_zero(side[k]))].net_gain;
                };
                if (!side[0] || !side[1]) return below(0) + below(1);
                if (!(set >> n & 1)) return 0.0;
                return from_bfloat16(splits.gain[std::size_t(n)]) - lambda + below(0) + below(1);
            };
            return net_gain(0);
        };
        double most = 0;
        for (int set = 0; set < 128; ++set) most = std::max(most, net_gain_of(set));
        EXPECT_NEAR(best.net_gain, most, 1e-12);
        EXPECT_NEAR(net_gain_of(split_mask), most, 1e-12);
        std::uint32_t parts = 0;
        for_each_part(splits, split_mask, [&](std::uint8_t) { ++parts; });
        EXPECT_EQ(best.count, parts);
    }
}

TEST(binary_splits, every_cut_has_the_moments_of_the_whole) {
    const Volume volume = test::random_volume(29, 0.05);
    const LatticeField field = lattice_field(volume);
    const CutTree tree = cut_tree(field);
    const std::size_t finest = finest_count(tree);
    const auto whole = [&](std::size_t budget) {
        const PackedCells cut = best_cut(std::span(&tree, 1), budget)[0];
        std::vector<Moments> cells;
        for (std::size_t i = 0; i < cut.size(); ++i) cells.push_back(cut[i]);
        EXPECT_LE(cells.size(), budget);
        if (budget < finest) {
            EXPECT_GE(1.02 * double(cells.size()) + 2, double(budget));
        } else {
            EXPECT_EQ(cells.size(), finest);
        }
        return joined_moments(cells);
    };
    const Moments one = whole(1);
    for (const std::size_t budget : {2, 3, 10, 100, 1000, 5000, 1000000}) {
        const Moments all = whole(budget);
        EXPECT_NEAR(all.mass / one.mass, 1, 1e-6);
        for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(all.mean[axis], one.mean[axis], 1e-4);
        for (std::size_t n = 0; n < 6; ++n)
            EXPECT_NEAR(all.covariance[n], one.covariance[n], 1e-4 * one.covariance[0]);
    }
}

}  // namespace
}  // namespace vog
