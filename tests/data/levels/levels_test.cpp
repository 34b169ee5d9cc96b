// levels_test.cpp: composite() of nested levels: mass, depth and counts of the visible parts.
#include "vog/levels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "data/levels/voxel_lookup.h"
#include "support/level_volumes.h"
#include "support/random_volume.h"
#include "support/ray_voxels.h"
#include "vog/error.h"

namespace vog {
namespace {

// Rounding of float32 densities, and of weighted ones once more: 1e-7 each.
constexpr double kFloat = 3e-7;

double total_mass(const Composite& data) {
    double sum = 0;
    for (const Volume& part : data.parts) sum += mass(part);
    return sum;
}

double total_mass(const Levels& levels) {
    double sum = 0;
    for (const Volume& volume : levels.volumes) sum += mass(volume);
    return sum;
}

/// Density of the finest active voxel at a world position, by a search of all leaves.
double brute_value(const Levels& levels, Vec3d world) {
    double value = 0, finest = INFINITY;
    for (const Volume& volume : levels.volumes) {
        const Vec3d at = inverse(volume.world_from_index)(world);
        const Vec3i voxel{int(std::floor(at.x + 0.5)), int(std::floor(at.y + 0.5)),
                          int(std::floor(at.z + 0.5))};
        for (const Leaf& leaf : volume.leaves) {
            const Vec3i d = voxel - leaf.origin;
            if (((d.x | d.y | d.z) & ~7) != 0 || !leaf.active(leaf_offset(d.x, d.y, d.z))) continue;
            if (voxel_volume(volume) >= finest) continue;
            finest = voxel_volume(volume);
            value = leaf.value[static_cast<std::size_t>(leaf_offset(d.x, d.y, d.z))];
        }
    }
    return value;
}

TEST(levels, mass_of_nested_cubes_is_that_of_the_outer_one) {
    for (const test::NestedScene& scene : test::nested_scenes()) {
        SCOPED_TRACE(scene.name);
        const Levels levels = test::nested_cubes(20, scene.outer, scene.inner);
        const Composite data = composite(levels);
        const double expected = mass(levels.volumes.front());
        EXPECT_NEAR(total_mass(data) / expected, 1, 1e-6);
        EXPECT_GT(total_mass(levels) / expected, 1.02) << "without masks it would be no test";
        EXPECT_EQ(data.partly_hidden > 0, scene.name.find("aligned") != std::string::npos ||
                                              scene.name.find("half") != std::string::npos);
        EXPECT_EQ(data.voxels + data.hidden, active_voxels(levels.volumes[0]) +
                                                 active_voxels(levels.volumes[1]) +
                                                 active_voxels(levels.volumes[2]));
        for (const Volume& part : data.parts) validate(part);
    }
}

TEST(levels, parts_add_up_to_the_constant_field) {
    for (const test::NestedScene& scene : test::nested_scenes()) {
        SCOPED_TRACE(scene.name);
        const Levels levels = test::nested_cubes(20, scene.outer, scene.inner);
        const Composite data = composite(levels);
        const Volume& outer = levels.volumes.front();
        test::Random random(1);
        for (int n = 0; n < 60; ++n) {
            const Vec3d target = outer.world_from_index(Vec3d{9.5, 9.5, 9.5} + random.in_cube(9));
            const Vec3d along = normalized(random.in_cube(1)), from = target - 60.0 * along;
            const auto [first, last] =
                test::IndexRay(outer, from, along).cut({-0.5, -0.5, -0.5}, {19.5, 19.5, 19.5});
            double sum = 0;
            for (const Volume& part : data.parts) sum += test::brute_depth(part, from, along);
            const double exact = 0.7f * (last - first);
            // Exact if lattices fit. Else a cut piece keeps its mass but not its shape: each seam
            // may be off by the depth of one piece.
            const double coarse = std::cbrt(voxel_volume(outer));
            const double tolerance = scene.fits ? 1e-6 * exact : 0.7 * coarse;
            ASSERT_NEAR(sum, exact, tolerance);
        }
    }
}

TEST(levels, levels_turned_against_each_other_are_sampled) {
    const Affine outer{{}, {0.25, 0, -3}};
    Levels levels;
    levels.volumes.push_back(test::cube_of(24, 0.7f, outer));
    const Mat3 turn = matrix_from_quat({0.9f, 0.1f, 0.3f, -0.2f});
    Affine inner{{{0.4 * turn.row[0], 0.4 * turn.row[1], 0.4 * turn.row[2]}}, {}};
    inner.translation = outer(Vec3d{11.5, 11.5, 11.5}) - inner.linear * Vec3d{11.5, 11.5, 11.5};
    levels.volumes.push_back(test::cube_of(24, 0.7f, inner));
    const Composite data = composite(levels);
    EXPECT_GT(data.partly_hidden, 0u);
    // 16^3 samples of each of the thousand voxels at the seam: errors of 0.2 % of a voxel each.
    EXPECT_NEAR(total_mass(data) / mass(levels.volumes.front()), 1, 1e-5);
}

TEST(levels, random_levels_keep_the_mass_of_what_is_seen) {
    for (const std::uint64_t seed : {1, 2, 3}) {
        test::Random random(seed);
        Levels levels;
        for (const double fill : {0.6, 0.4, 0.3}) {
            Volume& volume = levels.volumes.emplace_back();
            const double edge = 1.0 / static_cast<double>(levels.volumes.size());
            for (int axis = 0; axis < 3; ++axis) volume.world_from_index.linear(axis, axis) = edge;
            volume.world_from_index.translation = random.in_cube(2);
            for (int x = -1; x < 1; ++x)
                for (int y = -1; y < 1; ++y)
                    volume.leaves.push_back(test::random_leaf(random, {8 * x, 8 * y, 0}, fill));
            sort_nodes(volume);
        }
        // Stratified sampling, one random point per cell of a fine lattice: an independent
        // estimate.
        const Composite data = composite(levels);
        constexpr int kPoints = 128;
        double sum = 0;
        const Vec3d size = data.box.upper - data.box.lower;
        for (int x = 0; x < kPoints; ++x)
            for (int y = 0; y < kPoints; ++y)
                for (int z = 0; z < kPoints; ++z) {
                    const Vec3d share{(x + random()) / kPoints, (y + random()) / kPoints,
                                      (z + random()) / kPoints};
                    sum += brute_value(
                        levels, data.box.lower +
                                    Vec3d{share.x * size.x, share.y * size.y, share.z * size.z});
                }
        sum *= size.x * size.y * size.z / std::pow(kPoints, 3);
        EXPECT_NEAR(total_mass(data) / sum, 1, 1.5e-3) << total_mass(data) / sum - 1;
    }
}

TEST(levels, ghost_cells_of_a_neighbour_count_once_and_the_first_given_wins) {
    // Two halves of one level that overlap by two cells.
    Levels levels;
    test::VolumeMaker left, right;
    left.box({0, 0, 0}, {9, 7, 7}, 1);
    right.box({6, 0, 0}, {15, 7, 7}, 3);
    levels.volumes = {left.finish(), right.finish()};
    const Composite data = composite(levels);
    EXPECT_NEAR(total_mass(data), 64 * (10 * 1 + 6 * 3), 1e-9);
    EXPECT_EQ(data.hidden, 4u * 64);
    std::swap(levels.volumes[0], levels.volumes[1]);
    EXPECT_NEAR(total_mass(composite(levels)), 64 * (6 * 1 + 10 * 3), 1e-9);
}

TEST(levels, transforms_rounded_to_float_are_still_aligned) {
    const Affine coarse{{{Vec3d{1.0 / 3, 0, 0}, Vec3d{0, 1.0 / 3, 0}, Vec3d{0, 0, 1.0 / 3}}}, {}};
    Levels levels = test::nested_cubes(40, coarse, {{2, {20.5, 20.5, 20.5}, 16}});
    for (Volume& volume : levels.volumes)
        for (int axis = 0; axis < 3; ++axis) {
            double& edge = volume.world_from_index.linear(axis, axis);
            double& shift = volume.world_from_index.translation[axis];
            edge = static_cast<float>(edge), shift = static_cast<float>(shift);
        }
    const Composite data = composite(levels);
    EXPECT_EQ(data.partly_hidden, 0u);
    EXPECT_EQ(data.hidden, 8u * 8 * 8);
    EXPECT_EQ(data.parts.size(), 2u);
}

TEST(levels, far_apart_is_untouched_and_wholly_hidden_is_gone) {
    const Volume here = test::random_volume(4);
    Volume there = test::random_volume(5);
    there.world_from_index.translation = {1e6, 0, 0};
    there.world_from_index.linear = inverse(Mat3{{Vec3d{2, 0, 0}, Vec3d{0, 2, 0}, Vec3d{0, 0, 2}}});
    const Composite apart = composite({{here, there}, {}});
    ASSERT_EQ(apart.parts.size(), 2u);
    EXPECT_EQ(apart.hidden, 0u);
    EXPECT_EQ(apart.parts[1].leaves.size() + apart.parts[1].tiles.size(),
              here.leaves.size() - 1 + here.tiles.size())
        << "all but the leaf with no active voxel";
    EXPECT_NEAR(total_mass(apart) / (mass(here) + mass(there)), 1, kFloat);

    const Affine fine = test::nested_map({}, 2, {-0.5, -0.5, -0.5});
    const Levels hidden{{test::cube_of(8, 5, {}), test::cube_of(16, 1, fine)}, {}};
    const Composite only = composite(hidden);
    EXPECT_EQ(only.parts.size(), 1u);
    EXPECT_EQ(only.hidden, 512u);
    EXPECT_NEAR(total_mass(only), 512, 1e-9);
}

TEST(levels, one_level_stays_as_it_is) {
    const Volume volume = test::random_volume(6);
    const Composite data = composite({{volume}, {}});
    ASSERT_EQ(data.parts.size(), 1u);
    EXPECT_EQ(data.voxels, active_voxels(volume));
    EXPECT_EQ(data.parts[0].tiles.size(), volume.tiles.size());
    EXPECT_NEAR(total_mass(data) / mass(volume), 1, 1e-12);
    EXPECT_EQ(data.box, world_box(volume));
}

TEST(levels, tiles_are_taken_apart_where_a_finer_level_ends_in_them) {
    Levels levels;
    Volume& coarse = levels.volumes.emplace_back();
    coarse.tiles = {{{0, 0, 0}, 128, 0.5f}, {{128, 0, 0}, 8, 2}};
    levels.volumes.push_back(test::cube_of(20, 1, test::nested_map({}, 2, {121.5, -0.5, -0.5})));
    const Composite data = composite(levels);
    const double hidden = 6 * 100 * 0.5 + (2 * 64 + 2 * 36) * 0;
    // 6 x 10 x 10 voxels of the large tile, 4 x 8 x 8 of the small one.
    EXPECT_NEAR(total_mass(data), 128.0 * 128 * 128 * 0.5 - hidden + (512 - 4 * 8 * 8) * 2 + 1000.0,
                1e-3);
    EXPECT_EQ(data.hidden, 600u + 256);
    std::size_t tiles = 0;
    for (const Volume& part : data.parts) tiles += part.tiles.size();
    EXPECT_EQ(tiles, 16u * 16 * 16 - 4) << "1 x 2 x 2 blocks of the large tile are leaves now";
}

TEST(levels, masks_say_where_a_level_counts) {
    // The mask selects the middle of the fine level's 8^3 voxels, and a corner without active
    // voxels of the level: nothing is there.
    const Affine fine = test::nested_map({}, 2, {1.5, 1.5, 1.5});
    test::VolumeMaker level, mask, everywhere;
    level.volume.world_from_index = mask.volume.world_from_index = fine;
    level.box({0, 0, 0}, {7, 7, 7}, 1);
    mask.box({2, 2, 2}, {5, 5, 5}, 1);
    mask.box({8, 8, 8}, {9, 9, 9}, 1);
    const Levels levels{{test::cube_of(8, 3, {}), level.finish()},
                        {test::cube_of(8, 1, {}), mask.finish()}};
    const Composite data = composite(levels);
    EXPECT_NEAR(total_mass(data), 64 / 8.0 * 1 + (512 - 8 - 1) * 3, 1e-9);
    EXPECT_EQ(data.hidden, (512u - 64) + 9);
}

TEST(levels, finest_first_keeps_the_order_of_equals) {
    std::vector<Volume> volumes(5);
    const auto set_edge = [&](std::size_t n, double edge) {
        for (int axis = 0; axis < 3; ++axis) volumes[n].world_from_index.linear(axis, axis) = edge;
    };
    set_edge(1, 0.25), set_edge(2, 0.5), set_edge(3, 0.25 * (1 - 1e-7)), set_edge(4, -0.125);
    EXPECT_EQ(finest_first(volumes), (std::vector<std::size_t>{4, 1, 3, 2, 0}));
}

TEST(levels, unusable_input_throws) {
    EXPECT_THROW((void)composite({}), Error);
    const Volume cube = test::cube_of(8, 1, {});
    EXPECT_THROW((void)composite({{cube, cube}, {cube}}), Error);
    Volume flat = cube;
    flat.world_from_index.linear(2, 2) = 0;
    EXPECT_THROW((void)composite({{cube, flat}, {}}), Error);
    Volume bad = cube;
    bad.leaves[0].value[0] = NAN;
    EXPECT_THROW((void)composite({{bad}, {}}), Error);
}

TEST(voxel_lookup, agrees_with_the_volume) {
    const Volume volume = test::random_volume(9);
    const VoxelLookup lookup(volume);
    const test::LinearField field(volume);
    test::Random random(2);
    const auto at = [&](double low, double high) { return static_cast<int>(random(low, high)); };
    for (int n = 0; n < 3000; ++n) {
        const Vec3i lower{at(-40, 140), at(-40, 40), at(-140, 40)};
        const Vec3i upper = lower + Vec3i{at(0, 6), at(0, 6), at(0, 6)};
        int active = 0, all = 0;
        for (int x = lower.x; x <= upper.x; ++x)
            for (int y = lower.y; y <= upper.y; ++y)
                for (int z = lower.z; z <= upper.z; ++z, ++all) {
                    active += lookup.active({x, y, z});
                    ASSERT_EQ(lookup.value({x, y, z}), float(field.voxel({x, y, z})));
                }
        ASSERT_EQ(lookup.covers(lower, upper), active == all);
        if (active > 0) {
            ASSERT_TRUE(lookup.meets(lower, upper));
        }
    }
    EXPECT_FALSE(lookup.meets({40, 20, 20}, {90, 60, 60}));
    EXPECT_TRUE(lookup.meets({-100000, -100000, -100000}, {100000, 100000, 100000}));
    EXPECT_TRUE(lookup.covers({4096, 5, 5}, {8191, 4000, 4095}));
    EXPECT_FALSE(lookup.covers({4095, 5, 5}, {8191, 4000, 4095}));
}

}  // namespace
}  // namespace vog
