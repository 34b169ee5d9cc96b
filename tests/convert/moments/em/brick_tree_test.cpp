// brick_tree_test.cpp: bricks that boxes overlap, against a walk over all bricks.
#include "convert/moments/em/brick_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "convert/moments/cells/lattice_field.h"
#include "support/moment_volumes.h"
#include "support/scenes.h"

namespace vog {

using namespace moments;
namespace {

/// Leaves and tiles near each other and up to `range` voxels apart.
Volume scattered(int range) {
    test::Random random(9);
    test::VolumeMaker maker;
    for (int n = 0; n < 150; ++n) {
        const auto at = [&] { return static_cast<int>(random(-range, range)); };
        maker.set({at(), at(), at()}, 1);
    }
    Volume volume = maker.finish();
    for (int n = 0; n < 30; ++n) volume.tiles.push_back({{4096, 128 * n, 0}, 128, 1});
    return volume;
}

TEST(brick_tree, finds_the_bricks_of_every_box_in_the_whole_and_in_batches) {
    for (const int range : {100, 10000, 1000000000}) {
        const Volume volume = scattered(range);
        const LatticeField field = lattice_field(volume);
        const std::span<const Brick> bricks = field.bricks;
        const BrickTree tree(bricks);
        test::Random random(4);
        for (int n = 0; n < 300; ++n) {
            Vec3d lower, upper;
            for (int axis = 0; axis < 3; ++axis) {
                const double a = random(-1.1 * range, 1.1 * range), b = random(-range, range);
                lower[axis] = std::min(a, b), upper[axis] = std::max(a, b);
            }
            const VoxelBox box = voxel_box(lower, upper);
            const std::size_t batch = std::size_t{1} << (n % 9);
            const std::size_t begin = n % 2 ? 0 : bricks.size() / 2 / batch * batch;
            const std::size_t end = n % 2 ? bricks.size() : std::min(begin + batch, bricks.size());
            std::vector<std::size_t> found, expected;
            tree.for_each(box, begin, end, [&](std::size_t brick) { found.push_back(brick); });
            for (std::size_t b = begin; b < end; ++b) {
                bool overlaps = true;
                for (int axis = 0; axis < 3; ++axis) {
                    const double first = bricks[b].origin[axis] - 0.5;
                    overlaps = overlaps && lower[axis] < first + kLeafEdge * bricks[b].spacing &&
                               upper[axis] >= first;
                }
                if (overlaps) expected.push_back(b);
            }
            EXPECT_EQ(found, expected) << range << " " << n;
        }
    }
}

TEST(brick_tree, boxes_beyond_the_range_of_indices_are_limited) {
    const VoxelBox box = voxel_box({-1e300, -1e12, -0.5}, {1e300, 1e12, 0.49});
    EXPECT_EQ(box.first.x, std::numeric_limits<std::int32_t>::min());
    EXPECT_EQ(box.last.y, std::numeric_limits<std::int32_t>::max());
    EXPECT_EQ(box.first.z, 0);
    EXPECT_EQ(box.last.z, 0);
}

}  // namespace
}  // namespace vog
