// empty_space_test.cpp: gaps between parts of a cell against its standard deviation, extents of bricks.
#include "convert/moments/cut/empty_space.h"

#include <gtest/gtest.h>

#include "support/moment_volumes.h"
#include "support/random_volume.h"

namespace vog {

using namespace moments;
namespace {

Moments voxels_at(double from, double to, double mass) {
    const double edge = to - from, middle = 0.5 * (from + to);
    return {mass, {middle, 0, 0}, {edge * edge / 12, 0, 0, 1.0 / 12, 0, 1.0 / 12}};
}
Extent extent_of(double from, double to) { return {{from, -0.5, -0.5}, {to, 0.5, 0.5}, 1}; }

TEST(empty_space, a_gap_wider_than_the_standard_deviation_is_bridged) {
    for (const double gap : {0.0, 0.2, 1.0, 3.0, 100.0}) {
        const std::array<Moments, 2> parts{voxels_at(0, 1, 1), voxels_at(1 + gap, 2 + gap, 1)};
        const Moments whole = joined_moments(parts);
        const Extent a = extent_of(0, 1), b = extent_of(1 + gap, 2 + gap);
        // Two equal boxes: variance 1/12 + ((1 + gap) / 2)^2.
        const bool wider = gap * gap > 1.0 / 12 + 0.25 * (1 + gap) * (1 + gap);
        EXPECT_EQ(bridges(whole, a, b), wider) << gap;
        EXPECT_EQ(bridges(whole, b, a), wider) << gap;
    }
    const std::array<Moments, 2> touching{voxels_at(0, 1, 1000), voxels_at(1, 9, 1)};
    EXPECT_FALSE(bridges(joined_moments(touching), extent_of(0, 1), extent_of(1, 9)));
    EXPECT_FALSE(bridges(joined_moments(touching), {}, {})) << "all of space has no gaps";
}

TEST(empty_space, extents_of_a_brick_hold_its_voxels_and_no_more) {
    test::Random random(4);
    const Leaf leaf = test::random_leaf(random, {8, -16, 24}, 0.02);
    for (const double spacing : {1.0, 4.0}) {
        const Brick brick{leaf.origin, spacing, &leaf, 0, spacing};
        Box box;
        for (int n = 0; n < kLeafVoxels; ++n) {
            if (!(leaf.value[std::size_t(n)] > 0)) continue;
            const Vec3d lower = vec_cast<double>(leaf.origin) - Vec3d{0.5, 0.5, 0.5} +
                                spacing * Vec3d{double(n >> 6), double(n >> 3 & 7), double(n & 7)};
            box.include(lower), box.include(lower + Vec3d{spacing, spacing, spacing});
        }
        const Extent whole = brick_extents(brick)[0];
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(whole.lower[axis], box.lower[axis], 1e-9);
            EXPECT_NEAR(whole.upper[axis], box.upper[axis], 1e-9);
        }
        EXPECT_EQ(whole.voxel, spacing);
    }
    // A tile has no gaps: all of its nodes are full.
    const Brick tile{{0, 0, 0}, 16, nullptr, 1, 1};
    const auto extents = brick_extents(tile);
    EXPECT_NEAR(extents[0].upper.x - extents[0].lower.x, 128, 1e-9);
    EXPECT_NEAR(extents[1].upper.x, extents[5].lower.x, 1e-9);
    EXPECT_NEAR(extents[9].upper.z - extents[9].lower.z, 32, 1e-9);
}

}  // namespace
}  // namespace vog
