// octree_test.cpp: moments of the octree's cells against sums over the voxels in double precision.
#include "convert/moments/cells/octree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

#include "convert/moments/cells/lattice_field.h"
#include "core/morton.h"
#include "support/moment_volumes.h"

namespace vog {

using namespace moments;
namespace {

using test::random_volume;
using test::VolumeMaker;

MomentOctree octree_of(const Volume& volume) { return brick_octree(lattice_field(volume).bricks); }

MomentSums about_origin(const MomentCell& cell, int edge_log2) {
    return sums_of(cell_moments(cell, edge_log2));
}

/// scale  largest coordinate: second moments about the origin grow with its square
void expect_same_sums(const MomentSums& a, const MomentSums& b, double scale) {
    const double tolerance = 3e-7 * a.mass;  // cells are float32
    EXPECT_NEAR(a.mass, b.mass, tolerance);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(a.first[axis], b.first[axis], tolerance * scale);
    for (std::size_t n = 0; n < 6; ++n)
        EXPECT_NEAR(a.second[n], b.second[n], tolerance * scale * scale);
}

TEST(octree, a_parents_moments_are_the_sum_of_its_childrens) {
    const MomentOctree octree = octree_of(random_volume(21, 0.05));
    ASSERT_GT(octree.levels.size(), 3u);
    EXPECT_EQ(octree.levels.back().cells.size(), 1u);
    for (std::size_t level = 1; level < octree.levels.size(); ++level) {
        const MomentLevel &at = octree.levels[level], &finer = octree.levels[level - 1];
        std::uint32_t next = 0;
        for (const MomentCell& cell : at.cells) {
            if (cell.child_count == 0) continue;
            EXPECT_EQ(cell.first_child, next);  // children are contiguous, and all have parents
            next += cell.child_count;
            MomentSums sum;
            for (std::uint32_t child = 0; child < cell.child_count; ++child)
                add_shifted(
                    sum, about_origin(finer.cells[cell.first_child + child], finer.edge_log2), {});
            expect_same_sums(about_origin(cell, at.edge_log2), sum, 512);
        }
        EXPECT_EQ(next, finer.cells.size());
    }
}

TEST(octree, its_root_has_the_whole_mass_on_either_side_of_zero) {
    const Volume volume = random_volume(22, 0.05);
    const MomentOctree octree = octree_of(volume);
    ASSERT_EQ(octree.levels.back().cells.size(), 1u);
    EXPECT_NEAR(octree.levels.back().cells[0].mass * voxel_volume(volume) / mass(volume), 1, 1e-6);
    EXPECT_TRUE(octree_of(Volume{}).levels.empty());
}

TEST(octree, each_level_is_the_uniform_cut_of_its_size) {
    VolumeMaker maker;
    maker.box({-9, -3, 0}, {20, 17, 5}, 0.4f);
    maker.box({30, 0, 2}, {37, 1, 2}, 1.7f);
    const Volume volume = maker.finish();
    const MomentOctree octree = octree_of(volume);
    // The last level is a root around the cells that meet at index 0, and no aligned cube.
    for (std::size_t level = 0; level + 1 < octree.levels.size(); ++level) {
        const MomentLevel& at = octree.levels[level];
        std::map<std::tuple<int, int, int>, MomentSums> expected;
        for (const Leaf& leaf : volume.leaves)
            for (int n = 0; n < kLeafVoxels; ++n) {
                const double m = leaf.value[static_cast<std::size_t>(n)];
                if (m == 0) continue;
                const Vec3i index = leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7};
                const Vec3i cube = aligned(index, at.edge_log2);
                MomentSums& sums = expected[{cube.x, cube.y, cube.z}];
                const Vec3d x = vec_cast<double>(index);
                sums.mass += m;
                sums.first = sums.first + m * x;
                std::size_t k = 0;
                for (int a = 0; a < 3; ++a)
                    for (int b = a; b < 3; ++b)
                        sums.second[k++] += m * (x[a] * x[b] + (a == b ? 1.0 / 12 : 0));
            }
        ASSERT_EQ(at.cells.size(), expected.size()) << at.edge_log2;
        for (const MomentCell& cell : at.cells) {
            const auto found = expected.find({cell.origin.x, cell.origin.y, cell.origin.z});
            ASSERT_NE(found, expected.end());
            expect_same_sums(about_origin(cell, at.edge_log2), found->second, 40);
        }
    }
}

}  // namespace
}  // namespace vog
