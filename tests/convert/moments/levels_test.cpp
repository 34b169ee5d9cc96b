// levels_test.cpp: AMR levels as one model: shared octrees, ripple at seams, mass.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "convert/moments/cells/lattice_field.h"
#include "convert/moments/cut/optimal_cut.h"
#include "render/splat/splat.h"
#include "support/level_volumes.h"
#include "support/random_volume.h"
#include "support/ray_voxels.h"
#include "vog/convert_moments.h"
#include "vog/convert_paper.h"
#include "vog/error.h"
#include "vog/levels.h"
#include "vog/progress.h"

namespace vog {

using namespace moments;
namespace {

double total_mass(const Composite& data) {
    double sum = 0;
    for (const Volume& part : data.parts) sum += mass(part);
    return sum;
}

/// Root mean square of (T - exact) / exact over rays through the inner half of the outer cube,
/// farther from its faces than the supports of Gaussians.
double relative_error(const Gaussians& model, const Volume& outer, int across) {
    test::Random random(5);
    const double middle = 0.5 * (across - 1), upper = across - 0.5;
    double sum = 0;
    constexpr int kRays = 400;
    for (int n = 0; n < kRays; ++n) {
        const Vec3d target =
            outer.world_from_index(Vec3d{middle, middle, middle} + random.in_cube(0.25 * across));
        // Nearly along an axis, so that the ray enters and leaves by opposite faces.
        Vec3d tilt = random.in_cube(0.2);
        tilt[n % 3] = 1;
        const Vec3d along = normalized(outer.world_from_index.linear * tilt);
        const Vec3d from = target - 60.0 * along;
        const auto [first, last] =
            test::IndexRay(outer, from, along).cut({-0.5, -0.5, -0.5}, {upper, upper, upper});
        const double exact = 0.7f * (last - first);
        double depth = 0;
        for (std::size_t i = 0; i < model.size(); ++i)
            depth += optical_depth(model, i, from, along);
        const double error = depth / exact - 1;
        sum += error * error;
    }
    return std::sqrt(sum / kRays);
}

TEST(moment_levels, fields_have_all_the_mass_in_bricks_that_do_not_overlap) {
    for (const test::NestedScene& scene : test::nested_scenes()) {
        SCOPED_TRACE(scene.name);
        const Composite data = composite(test::nested_cubes(20, scene.outer, scene.inner));
        const std::vector<LatticeField> fields = lattice_fields(data.parts);
        const bool halves = scene.name.find("ratio_2") == 0 || scene.name.find("ratio_4") == 0;
        if (scene.fits && halves) {
            EXPECT_EQ(fields.size(), 1u);
        }
        double sum = 0;
        for (const LatticeField& field : fields) {
            std::map<std::tuple<int, int, int>, int> taken;  // blocks of 8^3 voxels
            for (const Brick& brick : field.bricks) {
                double brick_sum = 0;
                for (int n = 0; n < kLeafVoxels; ++n) brick_sum += double{brick.sample(n)};
                brick_sum *= brick.sample_volume();
                EXPECT_NEAR(brick_sums(brick).whole.mass / brick_sum, 1, 1e-6);
                sum += brick_sum * field.voxel_volume();
                const int blocks = static_cast<int>(brick.spacing);
                for (int x = 0; x < blocks; ++x)
                    for (int y = 0; y < blocks; ++y)
                        for (int z = 0; z < blocks; ++z)
                            EXPECT_EQ(
                                ++taken[std::tuple(brick.origin.x / 8 + x, brick.origin.y / 8 + y,
                                                   brick.origin.z / 8 + z)],
                                1);
            }
        }
        EXPECT_NEAR(sum / total_mass(data), 1, 1e-6);
    }
}

TEST(moment_levels, coarse_bricks_have_the_moments_of_their_voxels) {
    test::Random random(8);
    const Leaf leaf = test::random_leaf(random, {8, 16, -8}, 1.1);
    const Brick fine{leaf.origin, 1, &leaf, 0};
    const Brick coarse{4 * leaf.origin, 4, &leaf, 0};
    const BrickSums of_fine = brick_sums(fine), of_coarse = brick_sums(coarse);
    for (const std::size_t node : {0, 3, 40, 300}) {
        const Moments a = brick_node(fine, of_fine, node), b = brick_node(coarse, of_coarse, node);
        EXPECT_NEAR(b.mass, 64 * a.mass, 1e-9 * b.mass);
        // Sample i covers [i - 1/2, i + 1/2]; four times as wide, from 4 (i - 1/2) on.
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(b.mean[axis] + 0.5, 4 * (a.mean[axis] + 0.5), 1e-9);
        for (std::size_t n = 0; n < 6; ++n)
            EXPECT_NEAR(b.covariance[n], 16 * a.covariance[n], 1e-9);
    }
}

TEST(moment_levels, constant_field_is_constant_across_seams) {
    MomentOptions options;
    options.budget = 3000;
    // Truncated kernels ripple in any constant field, by 1 % of the chord after EM. In one octree
    // seams add little to that; between octrees each side has EM steps of its own.
    constexpr double kPlain = 0.015, kOneOctree = 0.02, kOctreesOfTheirOwn = 0.045;
    const Volume cube = test::cube_of(20, 0.7f, {});
    EXPECT_LT(relative_error(convert_moments(cube, options), cube, 20), kPlain);
    for (const test::NestedScene& scene : test::nested_scenes()) {
        SCOPED_TRACE(scene.name);
        const Levels levels = test::nested_cubes(20, scene.outer, scene.inner);
        const Composite data = composite(levels);
        const Volume& outer = levels.volumes.front();
        MomentReport report;
        const Gaussians model = convert_moments(data, options, &report);
        EXPECT_LE(model.size(), 3000u);
        EXPECT_NEAR(report.mass_ratio, 1, 1e-5);
        EXPECT_NEAR(mass(model) / total_mass(data), 1, 2e-4) << "1e-4 may be dropped";
        EXPECT_EQ(model.source_voxels, data.voxels);
        EXPECT_EQ(model.box, data.box);
        const bool one_octree = lattice_fields(data.parts).size() == 1;
        const double error = relative_error(model, outer, 20);
        EXPECT_LT(error, one_octree ? kOneOctree : kOctreesOfTheirOwn);

        Composite unmasked;
        unmasked.parts = levels.volumes;
        unmasked.box = data.box;
        EXPECT_GT(relative_error(convert_moments(unmasked, options), outer, 20), 0.1);
    }
}

TEST(moment_levels, the_papers_conversion_adds_up_over_levels) {
    for (const test::NestedScene& scene : test::nested_scenes()) {
        SCOPED_TRACE(scene.name);
        const Levels levels = test::nested_cubes(20, scene.outer, scene.inner);
        PaperOptions options;
        options.amplitude = Amplitude::mass;
        const auto convert = [&](const std::vector<Volume>& volumes) {
            Gaussians model;
            for (const Volume& volume : volumes) append(model, convert_paper(volume, options));
            return model;
        };
        const Composite data = composite(levels);
        const Gaussians model = convert(data.parts);
        EXPECT_NEAR(mass(model) / total_mass(data), 1, 1e-5);
        // The paper's kernels are those of hard blocks: 7 % rms of ripple in any constant field.
        EXPECT_LT(relative_error(model, levels.volumes[0], 20), 0.08);
        EXPECT_GT(relative_error(convert(levels.volumes), levels.volumes[0], 20), 0.2);
    }
}

TEST(moment_levels, blocks_count_the_voxels_of_each_level) {
    const test::NestedScene scene = test::nested_scenes()[0];
    const Composite data =
        composite(test::nested_cubes(24, scene.outer, {{2, {7.5, 7.5, 7.5}, 16}}));
    MomentOptions options;
    options.block_voxels = 2;
    options.mass_threshold = 0;
    // 24^3 less 8^3 coarse voxels and 16^3 fine ones; the block of coarse voxels around the fine
    // level shares no cube with it, so nothing is divided.
    const Gaussians model = convert_moments(data, options);
    EXPECT_EQ(model.size(), (24u * 24 * 24 - 8 * 8 * 8 + 16 * 16 * 16) / 8);
    EXPECT_NEAR(mass(model) / total_mass(data), 1, 1e-6);
    for (const int block : {1, 4, 8, 16, 64}) {
        options.block_voxels = block;
        EXPECT_NEAR(mass(convert_moments(data, options)) / total_mass(data), 1, 1e-6) << block;
    }
}

TEST(moment_levels, a_budget_goes_where_gains_are_scaled_up) {
    // Two equal fields: only the scale of their gains decides which is cut more finely.
    const Volume volume = test::random_volume(3, 0.3);
    const LatticeField field = lattice_field(volume);
    const std::vector<CutTree> trees{cut_tree(field, 1), cut_tree(field, 10)};
    const auto cells = best_cut(trees, 900);
    EXPECT_LE(cells[0].size() + cells[1].size(), 900u);
    // To 2 %: a split over a gap comes with those above it.
    EXPECT_GE(cells[0].size() + cells[1].size(), 882u);
    EXPECT_LT(cells[0].size(), cells[1].size());
    const auto fewest = best_cut(trees, 1);
    EXPECT_EQ(fewest[0].size(), 1u) << "at least one of each";
    EXPECT_EQ(fewest[1].size(), 1u);
}

TEST(moment_levels, one_level_is_converted_as_a_volume_is) {
    const Volume volume = test::random_volume(3, 0.3);
    MomentOptions options;
    options.budget = 500;
    const Gaussians alone = convert_moments(volume, options);
    const Gaussians composed = convert_moments(composite({{volume}, {}}), options);
    EXPECT_EQ(alone.mean, composed.mean);
    EXPECT_EQ(alone.scale, composed.scale);
    EXPECT_EQ(alone.density, composed.density);
    EXPECT_EQ(alone.source, composed.source);
    EXPECT_EQ(alone.box, composed.box);
}

TEST(moment_levels, the_error_holds_over_all_levels) {
    const test::NestedScene scene = test::nested_scenes()[4];
    const Composite data = composite(test::nested_cubes(20, scene.outer, scene.inner));
    MomentOptions options;
    options.error = 0.15;
    MomentReport report;
    const Gaussians model = convert_moments(data, options, &report);
    EXPECT_LE(report.measured_error, options.error);
    EXPECT_LT(model.size(), data.voxels / 3);
}

TEST(moment_levels, same_bytes_for_any_number_of_threads) {
    const test::NestedScene scene = test::nested_scenes()[5];
    const Composite data = composite(test::nested_cubes(20, scene.outer, scene.inner));
    MomentOptions options;
    options.budget = 700;
    const Gaussians all = convert_moments(data, options);
    const ThreadLimit limit(1);
    const Gaussians one =
        convert_moments(composite(test::nested_cubes(20, scene.outer, scene.inner)), options);
    EXPECT_EQ(all.mean, one.mean);
    EXPECT_EQ(all.rotation, one.rotation);
    EXPECT_EQ(all.density, one.density);
}

TEST(moment_levels, tiny_and_huge_voxels_share_a_budget) {
    // Priorities in units of the voxel would be out of a float's range.
    const Affine tiny{{{Vec3d{1e-24, 0, 0}, Vec3d{0, 1e-24, 0}, Vec3d{0, 0, 1e-24}}}, {}};
    for (const Affine& map :
         {tiny, Affine{{{Vec3d{1e20, 0, 0}, Vec3d{0, 1e20, 0}, Vec3d{0, 0, 1e20}}}, {}}}) {
        Levels levels = test::nested_cubes(16, map, {{3, {4.5, 4.5, 4.5}, 18}});
        const Composite data = composite(levels);
        MomentOptions options;
        options.budget = 300;
        MomentReport report;
        EXPECT_GT(convert_moments(data, options, &report).size(), 100u);
        EXPECT_NEAR(report.mass_ratio, 1, 1e-5);
    }
}

TEST(moment_levels, nothing_left_throws) {
    EXPECT_THROW((void)convert_moments(Composite{}), Error);
}

}  // namespace
}  // namespace vog
