// reference_levels_test.cpp: Rays through levels that hide each other, against closed forms and a sum
// over small steps.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/reference/reference.h"
#include "support/level_volumes.h"
#include "support/random_volume.h"
#include "support/ray_voxels.h"
#include "vog/error.h"

namespace vog {
namespace {

constexpr double kLevelsRounding = 1e-10;

struct Ray {
    Vec3d origin, direction;
};

/// Rays through a cube of voxels, from outside and from inside.
std::vector<Ray> rays_through(const Volume& cube, int across, int count) {
    test::Random random(7);
    std::vector<Ray> rays;
    const double middle = 0.5 * (across - 1);
    for (int n = 0; n < count; ++n) {
        const Vec3d target =
            cube.world_from_index(Vec3d{middle, middle, middle} + random.in_cube(0.5 * across));
        Vec3d along = normalized(random.in_cube(1));
        if (n % 8 == 1) along = normalized(cube.world_from_index.linear.column(n / 8 % 3));
        rays.push_back({n % 4 == 0 ? target : target - (3.0 * across) * along, along});
    }
    return rays;
}

double chord(const Volume& cube, int across, const Ray& ray) {
    const double upper = across - 0.5;
    const auto [first, last] = test::IndexRay(cube, ray.origin, ray.direction)
                                   .cut({-0.5, -0.5, -0.5}, {upper, upper, upper});
    return last - first;
}

TEST(reference_levels, constant_field_has_the_chord_of_the_outer_box) {
    for (const test::NestedScene& scene : test::nested_scenes()) {
        SCOPED_TRACE(scene.name);
        const Levels levels = test::nested_cubes(20, scene.outer, scene.inner);
        const Volume& outer = levels.volumes.front();
        const LevelGrids grids = level_grids(levels);
        std::vector<VoxelGrid> unmasked;
        for (const Volume& volume : levels.volumes) unmasked.push_back(voxel_grid(volume));
        double worst = 0;
        for (const Ray& ray : rays_through(outer, 20, 400)) {
            const double exact = 0.7f * chord(outer, 20, ray);
            ASSERT_NEAR(optical_depth(grids, ray.origin, ray.direction), exact, kLevelsRounding);
            double sum = 0;
            for (const VoxelGrid& grid : unmasked)
                sum += optical_depth(grid, ray.origin, ray.direction);
            worst = std::max(worst, std::abs(sum - exact));
        }
        EXPECT_GT(worst, 1) << "plain sums of the grids should count the overlap twice";
    }
}

TEST(reference_levels, linear_field_of_a_constant_is_constant_across_seams) {
    for (const test::NestedScene& scene : test::nested_scenes()) {
        SCOPED_TRACE(scene.name);
        const Levels levels = test::nested_cubes(20, scene.outer, scene.inner);
        const Volume& outer = levels.volumes.front();
        for (const double step : {0.0, 0.25}) {
            const LevelGrids grids = level_grids(levels, {Interpolation::linear, step});
            for (const Ray& ray : rays_through(outer, 20, 100))
                ASSERT_NEAR(optical_depth(grids, ray.origin, ray.direction),
                            0.7f * chord(outer, 20, ray), 1e-6);
        }
    }
}

TEST(reference_levels, linear_field_of_a_ramp_is_that_ramp_across_seams) {
    // Density is the coordinate along x, which trilinear interpolation gives exactly where both
    // sides are of one level; at a seam the layer beyond has the coarse voxel's value, so that the
    // error is below half a coarse voxel over the depth of one.
    const auto ramp = [](Volume& volume) {
        for (Leaf& leaf : volume.leaves)
            for (int n = 0; n < kLeafVoxels; ++n)
                if (leaf.active(n))
                    leaf.set(n, float(volume
                                          .world_from_index(vec_cast<double>(
                                              leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7}))
                                          .x));
    };
    Levels levels = test::nested_cubes(20, {{}, {1, 0, 0}}, {{2, {4.5, 3.5, 5.5}, 18}});
    for (Volume& volume : levels.volumes) ramp(volume);
    const LevelGrids linear = level_grids(levels, {Interpolation::linear, 0});
    // Along x through the fine level: from 0.5 to 20.5, where the integral of x is 210; the ends
    // are flat for half a voxel.
    const double depth = optical_depth(linear, {-9, 9.2, 9.1}, {1, 0, 0});
    EXPECT_NEAR(depth, 210, 0.3);
}

TEST(reference_levels, levels_at_any_angle_match_small_steps) {
    test::Random random(3);
    Levels levels;
    int seed = 30;
    for (const double edge : {0.5, 0.2, 0.31}) {
        Volume& volume = levels.volumes.emplace_back();
        test::Random fill(static_cast<std::uint64_t>(++seed));
        for (int x = -1; x < 1; ++x)
            for (int y = -1; y < 1; ++y)
                for (int z = -1; z < 1; ++z)
                    volume.leaves.push_back(test::random_leaf(fill, {8 * x, 8 * y, 8 * z}, 0.4));
        volume.tiles = {{{8, 0, 0}, 8, 0.5f}};
        volume.world_from_index.linear = matrix_from_quat(random.rotation());
        for (Vec3d& row : volume.world_from_index.linear.row) row = edge * row;
    }
    const LevelGrids grids = level_grids(levels);
    std::vector<test::LinearField> fields;
    for (const Volume& volume : levels.volumes) fields.emplace_back(volume);
    const auto value = [&](Vec3d world) {
        for (const std::size_t n : {1, 2, 0}) {
            const Vec3d at = inverse(levels.volumes[n].world_from_index)(world);
            const Vec3i voxel{int(std::floor(at.x + 0.5)), int(std::floor(at.y + 0.5)),
                              int(std::floor(at.z + 0.5))};
            if (const double found = fields[n].voxel(voxel); found > 0) return found;
        }
        return 0.0;
    };
    for (int n = 0; n < 40; ++n) {
        const Vec3d along = normalized(random.in_cube(1)), from = random.in_cube(2) - 8.0 * along;
        constexpr int kSteps = 16000;
        constexpr double kStep = 16.0 / kSteps;
        double sum = 0;
        for (int k = 0; k < kSteps; ++k) sum += value(from + (k + 0.5) * kStep * along) * kStep;
        // At each of about 100 voxel faces the sum errs by up to half a step of a density up to 2.
        ASSERT_NEAR(optical_depth(grids, from, along), sum, 100 * 0.5 * kStep * 2 * 0.2) << n;
    }
}

TEST(reference_levels, ghost_cells_count_once_and_the_first_given_wins) {
    test::VolumeMaker left, right;
    left.box({0, 0, 0}, {9, 7, 7}, 1);
    right.box({6, 0, 0}, {15, 7, 7}, 3);
    EXPECT_NEAR(
        optical_depth(level_grids({{left.finish(), right.finish()}, {}}), {-5, 3, 3}, {1, 0, 0}),
        10 * 1 + 6 * 3, kLevelsRounding);
    EXPECT_NEAR(
        optical_depth(level_grids({{right.finish(), left.finish()}, {}}), {-5, 3, 3}, {1, 0, 0}),
        6 * 1 + 10 * 3, kLevelsRounding);
}

TEST(reference_levels, masks_say_where_a_level_counts) {
    const Affine fine = test::nested_map({}, 2, {1.5, 1.5, 1.5});
    test::VolumeMaker mask;
    mask.volume.world_from_index = fine;
    mask.box({2, 0, 0}, {9, 7, 7}, 1);  // from x = 2.5 to 6.5, of which the level has up to 5.5
    const Levels levels{{test::cube_of(8, 3, {}), test::cube_of(8, 1, fine)},
                        {test::cube_of(8, 1, {}), mask.finish()}};
    const double exact = 3 * 3 + 3 * 1 + 1 * 0 + 1 * 3;
    EXPECT_NEAR(optical_depth(level_grids(levels), {-5, 3, 3}, {1, 0, 0}), exact, kLevelsRounding);
    // And the parts agree.
    double sum = 0;
    for (const Volume& part : composite(levels).parts)
        sum += test::brute_depth(part, {-5, 3, 3}, {1, 0, 0});
    EXPECT_NEAR(sum, exact, 1e-6);
}

TEST(reference_levels, zero_density_hides_too) {
    const Affine fine = test::nested_map({}, 2, {1.5, 1.5, 1.5});
    const Levels levels{{test::cube_of(8, 1, {}), test::cube_of(4, 0, fine)}, {}};
    EXPECT_NEAR(optical_depth(level_grids(levels), {-5, 2.2, 2.2}, {1, 0, 0}), 6, kLevelsRounding);
    EXPECT_NEAR(mass(composite(levels).parts.back()), 512 - 8, 1e-9);
}

TEST(reference_levels, one_level_is_the_plain_reference) {
    const Volume volume = test::random_volume(12);
    const LevelGrids levels = level_grids({{volume}, {}});
    const VoxelGrid grid = voxel_grid(volume);
    const Camera camera = paper_view({{-9, -9, -9}, {17, 17, 17}});
    const DepthImage a = render_reference(levels, camera, 33, 20);
    const DepthImage b = render_reference({&grid, 1}, camera, 33, 20);
    for (std::size_t n = 0; n < a.depth.size(); ++n)
        ASSERT_NEAR(a.depth[n], b.depth[n], 2e-7 * (b.depth[n] + 1e-3));
}

TEST(reference_levels, same_bytes_for_any_number_of_threads) {
    const test::NestedScene scene = test::nested_scenes()[4];
    const LevelGrids grids = level_grids(test::nested_cubes(20, scene.outer, scene.inner));
    const Camera camera = paper_view({{-2, -2, -5}, {20, 20, 20}});
    const auto render = [&](int threads) {
        const ThreadLimit limit(threads);
        return render_reference(grids, camera, 65, 33).depth;
    };
    EXPECT_EQ(render(1), render(2));
}

TEST(reference_levels, unusable_input_throws) {
    EXPECT_THROW((void)level_grids({}), Error);
    const Volume cube = test::cube_of(8, 1, {});
    EXPECT_THROW((void)level_grids({{cube, cube}, {cube}}), Error);
    EXPECT_THROW((void)level_grids({{cube}, {}}, {Interpolation::linear, -1}), Error);
    EXPECT_THROW((void)optical_depth(level_grids({{cube}, {}}), {0, 0, 0}, {0, 0, 0}), Error);
}

}  // namespace
}  // namespace vog
