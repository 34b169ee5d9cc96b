// convert_moments_test.cpp: the moment conversion against closed forms: mass, mean, covariance, T.
#include "vog/convert_moments.h"
#include "vog/memory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "support/moment_volumes.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/progress.h"
#include "vog/sample.h"

namespace vog {
namespace {

using test::covariance;
using test::VolumeMaker;

// Models are float32: a few roundings of 6e-8.
constexpr double kFloat = 1e-6;

MomentOptions block(int voxels) {
    MomentOptions options;
    options.block_voxels = voxels;
    options.soft_steps = 0;
    options.mass_threshold = 0;
    return options;
}

void expect_near(const Mat3& a, const Mat3& b, double tolerance) {
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            EXPECT_NEAR(a(row, column), b(row, column), tolerance) << row << " " << column;
}

TEST(moments, a_single_voxel_is_a_box_with_its_mass_and_variance) {
    VolumeMaker maker;
    maker.set({5, -3, 9}, 2);
    maker.volume.world_from_index = {{{Vec3d{2, 0, 0}, Vec3d{0, 0.5, 0}, Vec3d{0, 0, 1}}},
                                     {1, 2, 3}};
    for (const int edge : {1, 2, 4, 8, 16, 128}) {
        const Gaussians model = convert_moments(maker.finish(), block(edge));
        ASSERT_EQ(model.size(), 1u) << edge;
        EXPECT_NEAR(mass(model), 2, 2 * kFloat);
        EXPECT_NEAR(model.mean[0].x, 11, 11 * kFloat);
        EXPECT_NEAR(model.mean[0].y, 0.5, kFloat);
        EXPECT_NEAR(model.mean[0].z, 12, 12 * kFloat);
        expect_near(covariance(model, 0),
                    {{Vec3d{4.0 / 12, 0, 0}, Vec3d{0, 0.25 / 12, 0}, Vec3d{0, 0, 1.0 / 12}}},
                    kFloat);
    }
}

TEST(moments, a_constant_box_has_its_exact_covariance) {
    // 4 x 6 x 2 voxels inside one cell of 8: variances n²/12.
    VolumeMaker maker;
    maker.box({0, 1, 3}, {3, 6, 4}, 0.7f);
    const Gaussians model = convert_moments(maker.finish(), block(8));
    ASSERT_EQ(model.size(), 1u);
    EXPECT_NEAR(mass(model), 0.7 * 48, 34 * kFloat);
    EXPECT_NEAR(model.mean[0].x, 1.5, kFloat * 2);
    EXPECT_NEAR(model.mean[0].y, 3.5, kFloat * 4);
    EXPECT_NEAR(model.mean[0].z, 3.5, kFloat * 4);
    expect_near(covariance(model, 0),
                {{Vec3d{16.0 / 12, 0, 0}, Vec3d{0, 36.0 / 12, 0}, Vec3d{0, 0, 4.0 / 12}}},
                3 * kFloat);
}

TEST(moments, a_gaussian_sampled_on_voxels_comes_back_as_itself) {
    // Standard deviations well above a voxel: sums over voxel centres equal the integrals to far
    // below 1e-4 (Poisson summation: exp(-2 π² s²)). The whole of it lies in one cell of 64.
    const Mat3 rotation = matrix_from_quat({0.8f, 0.3f, -0.4f, 0.33f});
    const Vec3d s{5, 3, 2}, center{31.3, 32.1, 30.7};
    VolumeMaker maker;
    for (int x = 0; x < 64; ++x)
        for (int y = 0; y < 64; ++y)
            for (int z = 0; z < 64; ++z) {
                const Vec3d d =
                    transpose(rotation) * (Vec3d{double(x), double(y), double(z)} - center);
                const double m2 =
                    std::pow(d.x / s.x, 2) + std::pow(d.y / s.y, 2) + std::pow(d.z / s.z, 2);
                maker.set({x, y, z}, static_cast<float>(std::exp(-0.5 * m2)));
            }
    constexpr double kVoxel = 0.25;
    maker.volume.world_from_index.linear = {
        {Vec3d{kVoxel, 0, 0}, Vec3d{0, kVoxel, 0}, Vec3d{0, 0, kVoxel}}};
    const Gaussians model = convert_moments(maker.finish(), block(64));
    ASSERT_EQ(model.size(), 1u);
    const double expected_mass = std::pow(2 * std::numbers::pi, 1.5) * 30 * std::pow(kVoxel, 3);
    EXPECT_NEAR(mass(model) / expected_mass, 1, 1e-4);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(model.mean[0][axis], kVoxel * center[axis], 1e-4);
    Mat3 expected = rotation;
    for (int axis = 0; axis < 3; ++axis)
        for (int row = 0; row < 3; ++row) expected(row, axis) *= s[axis];
    expected = expected * transpose(expected);
    for (int axis = 0; axis < 3; ++axis) expected(axis, axis) += 1.0 / 12;
    for (Vec3d& row : expected.row) row = kVoxel * kVoxel * row;
    expect_near(covariance(model, 0), expected, 1e-4);
}

TEST(moments, a_rotated_and_sheared_grid_maps_the_moments) {
    VolumeMaker maker;
    maker.box({0, 0, 0}, {5, 2, 1}, 1.5f);
    const Mat3 map{{Vec3d{0.3, -0.2, 0.05}, Vec3d{0.1, 0.5, 0.2}, Vec3d{-0.1, 0.1, 0.4}}};
    maker.volume.world_from_index = {map, {10, -20, 30}};
    const Gaussians model = convert_moments(maker.finish(), block(8));
    ASSERT_EQ(model.size(), 1u);
    const Mat3 index{{Vec3d{36.0 / 12, 0, 0}, Vec3d{0, 9.0 / 12, 0}, Vec3d{0, 0, 4.0 / 12}}};
    expect_near(covariance(model, 0), map * index * transpose(map), kFloat);
    EXPECT_NEAR(mass(model), 1.5 * 36 * determinant(map), kFloat * 5);
    const Vec3d center = map * Vec3d{2.5, 1, 0.5} + Vec3d{10, -20, 30};
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(model.mean[0][axis], center[axis], 30 * kFloat);
}

TEST(moments, axis_aligned_models_keep_mass_mean_and_the_axes_variances) {
    const Volume volume = test::random_volume(11, 0.2);
    MomentOptions options = block(4);
    const Gaussians full = convert_moments(volume, options);
    options.axis_aligned = true;
    const Gaussians aligned = convert_moments(volume, options);
    ASSERT_EQ(full.size(), aligned.size());
    EXPECT_TRUE(aligned.axis_aligned());
    EXPECT_EQ(full.mean, aligned.mean);
    EXPECT_NEAR(mass(aligned) / mass(full), 1, kFloat);
    for (std::size_t i = 0; i < full.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(covariance(aligned, i)(axis, axis), covariance(full, i)(axis, axis), 1e-5);
}

TEST(moments, spread_widens_at_constant_mass) {
    MomentOptions options = block(4);
    const Volume volume = test::random_volume(12, 0.2);
    const Gaussians one = convert_moments(volume, options);
    options.spread = 1.5f;
    const Gaussians wide = convert_moments(volume, options);
    EXPECT_NEAR(mass(wide) / mass(one), 1, kFloat);
    EXPECT_NEAR(wide.scale[0].x / one.scale[0].x, 1.5, 1e-5);
}

TEST(moments, a_sheet_one_voxel_thick_is_right_from_the_side_and_edge_on) {
    VolumeMaker maker;
    maker.box({0, 0, 4}, {63, 63, 4}, 1);
    const Volume volume = maker.finish();
    const VoxelGrid grid = voxel_grid(volume);
    for (const int edge : {4, 8, 16, 128}) {
        const Gaussians model = convert_moments(volume, block(edge));
        validate(model);
        for (std::size_t i = 0; i < model.size(); ++i)
            EXPECT_NEAR(std::sqrt(variance_within(model.cutoff)) * model.scale[i].z,
                        std::sqrt(1.0 / 12), 1e-5);
    }
    // T of the sheet's middle, averaged over a cell: through its thickness, and along it.
    const Gaussians model = convert_moments(volume, block(8));
    const auto depth = [&](Vec3d origin, Vec3d direction) {
        double sum = 0;
        for (std::size_t i = 0; i < model.size(); ++i)
            sum += optical_depth(model, i, origin, direction);
        return sum;
    };
    double from_side = 0, edge_on = 0, exact_edge_on = 0;
    constexpr int kRays = 18;  // a third of the rows in z meets the sheet
    for (int row = 0; row < kRays; ++row) {
        for (int column = 0; column < kRays; ++column)
            from_side += depth({28 + 8 * (row + 0.5) / kRays, 28 + 8 * (column + 0.5) / kRays, -50},
                               {0, 0, 1}) /
                         (kRays * kRays);
        const double z = 2.5 + 3 * (row + 0.5) / kRays;
        for (int column = 0; column < kRays; ++column) {
            const Vec3d eye{-50, 28 + 8 * (column + 0.5) / kRays, z};
            edge_on += depth(eye, {1, 0, 0}) / kRays;
            exact_edge_on += optical_depth(grid, eye, {1, 0, 0}) / kRays;
        }
    }
    // Inside the sheet neighbours add up to the constant: their tails leave and enter alike.
    EXPECT_NEAR(from_side, 1, 0.01);
    EXPECT_NEAR(edge_on / exact_edge_on, 1, 0.06);
}

TEST(moments, two_far_clusters_in_one_cell_are_spanned) {
    VolumeMaker maker;
    maker.set({0, 0, 0}, 3);
    maker.set({127, 0, 0}, 1);
    const Gaussians model = convert_moments(maker.finish(), block(128));
    ASSERT_EQ(model.size(), 1u);
    EXPECT_NEAR(model.mean[0].x, 127.0 / 4, 1e-4);
    // Variance of a coin of 3/4: d² 3/16, plus the box.
    EXPECT_NEAR(covariance(model, 0)(0, 0) / (127.0 * 127 * 3 / 16 + 1.0 / 12), 1, 1e-5);
    EXPECT_NEAR(covariance(model, 0)(1, 1), 1.0 / 12, 1e-4);
}

TEST(moments, tiles_enter_as_nodes_with_the_variance_of_a_box) {
    VolumeMaker maker;
    maker.volume.tiles = {{{0, 0, 0}, 8, 0.5f}, {{128, 0, 0}, 128, 0.25f}};
    const Volume volume = maker.finish();
    const Gaussians model = convert_moments(volume, block(128));
    ASSERT_EQ(model.size(), 2u);
    EXPECT_NEAR(covariance(model, 0)(0, 0), 64.0 / 12, 1e-4);
    EXPECT_NEAR(covariance(model, 1)(0, 0) / (128.0 * 128 / 12), 1, kFloat);
    EXPECT_NEAR(mass(model) / mass(volume), 1, kFloat);
    // Cut no finer than an eighth of the tile: 4^3 cells of the first, 8^3 of the second.
    EXPECT_EQ(convert_moments(volume, block(2)).size(), 64u + 512u);
}

TEST(moments, mass_is_conserved_by_every_cut) {
    const Volume volume = test::random_volume(5, 0.02);
    std::vector<MomentOptions> all;
    for (int edge = 1; edge <= 128; edge *= 2) {
        all.push_back(block(edge));
        all.push_back(block(edge));
        all.back().soft_steps = 2;
    }
    for (const std::size_t budget : {1, 2, 7, 50, 400, 100000}) {
        all.emplace_back();
        all.back().budget = budget;
        all.back().mass_threshold = 0;
    }
    for (const MomentOptions& options : all) {
        MomentReport report;
        const Gaussians model = convert_moments(volume, options, &report);
        validate(model);
        EXPECT_NEAR(mass(model) / mass(volume), 1, 1e-5) << model.options;
        EXPECT_NEAR(report.mass_ratio, 1, 1e-5) << model.options;
        EXPECT_EQ(report.dropped_cells, 0u);
        if (options.budget) {
            EXPECT_LE(model.size(), options.budget);
        }
    }
}

TEST(moments, the_threshold_drops_no_more_than_its_share_and_says_so) {
    // Masses spread evenly over [0.1, 10]: a bin of 1 % holds little.
    VolumeMaker maker;
    test::Random random(6);
    for (int n = 0; n < 4096; ++n)
        maker.set({n & 15, n >> 4 & 15, n >> 8}, static_cast<float>(random(0.1, 10)));
    const Volume volume = maker.finish();
    for (const double share : {1e-3, 0.05, 0.5}) {
        MomentOptions options = block(1);
        options.mass_threshold = share;
        MomentReport report;
        const Gaussians model = convert_moments(volume, options, &report);
        EXPECT_LE(report.dropped_mass_share, share);
        EXPECT_GE(report.dropped_mass_share, 0.9 * share - 5e-4);
        EXPECT_EQ(report.dropped_cells + model.size(), 4096u);
        EXPECT_NEAR(mass(model) / mass(volume), 1 - report.dropped_mass_share, 1e-5);
        EXPECT_NEAR(report.mass_ratio, 1, 1e-5);
    }
}

TEST(moments, the_summary_reports_counts_mass_and_error) {
    const Volume volume = sample_cloud({.size = 64});
    MomentReport report;
    const Gaussians model =
        convert_moments(volume, {.budget = 300, .mass_threshold = 0.01, .measure = true}, &report);
    EXPECT_EQ(model.summary, summary_text(model, report, "active voxels"));
    EXPECT_EQ(model.summary.find(std::to_string(model.size()) + " Gaussians, "), 0u);
    EXPECT_NE(model.summary.find(" % of the active voxels, mass ratio 0.99"), std::string::npos)
        << "of the written model, without the dropped cells: " << model.summary;
    EXPECT_NE(model.summary.find("with 0.0"), std::string::npos)
        << "a share, not a mass: " << model.summary;
    EXPECT_NE(model.summary.find("measured error 0.0"), std::string::npos) << model.summary;
}

TEST(moments, bad_options_and_volumes_throw) {
    const Volume volume = test::random_volume(7, 0.01);
    const auto refuses = [&](auto change) {
        MomentOptions options = block(4);
        change(options);
        EXPECT_THROW((void)convert_moments(volume, options), Error);
    };
    refuses([](MomentOptions& o) { o.block_voxels = 3; });
    refuses([](MomentOptions& o) { o.block_voxels = 256; });
    refuses([](MomentOptions& o) { o.block_voxels = -1; });
    refuses([](MomentOptions& o) { o.budget = 5; });
    refuses([](MomentOptions& o) { o.error = -0.1; });
    refuses([](MomentOptions& o) { o.error = NAN; });
    refuses([](MomentOptions& o) { o.spread = 3; });
    refuses([](MomentOptions& o) { o.mass_threshold = 1; });
    refuses([](MomentOptions& o) { o.soft_steps = -2; });
    EXPECT_THROW((void)convert_moments(Volume{}, block(4)), Error);
    VolumeMaker empty;
    empty.set({0, 0, 0}, 0);
    EXPECT_THROW((void)convert_moments(empty.finish(), block(4)), Error);
    EXPECT_THROW((void)moment_lod(0), Error);
    EXPECT_THROW((void)moment_lod(6), Error);
}

std::vector<char> bytes_of(const Gaussians& model) {
    std::vector<char> bytes;
    const auto add = [&](const auto& values) {
        const auto* first = reinterpret_cast<const char*>(values.data());
        bytes.insert(bytes.end(), first, first + values.size() * sizeof(values[0]));
    };
    add(model.mean), add(model.scale), add(model.rotation), add(model.density);
    return bytes;
}

TEST(moments, any_number_of_threads_gives_the_same_bytes) {
    std::vector<MomentOptions> all(6);
    all[0].block_voxels = 2;
    all[1].block_voxels = 16;
    all[2].budget = 300;
    all[3].error = 0.3;
    all[4].block_voxels = 4;
    all[4].soft_steps = 3;
    all[5].budget = 3000;
    all[5].soft_steps = 2;
    for (const std::uint64_t seed : {23, 24, 25}) {
        const Volume volume = test::random_volume(seed, seed == 24 ? 0.5 : 0.05);
        for (const MomentOptions& options : all) {
            std::vector<char> one;
            for (const int threads : {1, 2, 3, 8}) {
                const ThreadLimit limit(threads);
                const std::vector<char> bytes = bytes_of(convert_moments(volume, options));
                if (threads == 1)
                    one = bytes;
                else
                    EXPECT_EQ(one, bytes) << seed << ' ' << threads;
            }
        }
    }
}

/// 64 MiB is the least limit, and arrays from 4 MiB on lie in files: 2,200 leaves do.
TEST(moments, a_memory_limit_gives_the_same_bytes) {
    const auto generated = [] {
        test::Random values(26);
        Volume volume;
        for (int n = 0; n < 13 * 13 * 13; ++n) {
            Leaf& leaf = volume.leaves.emplace_back();
            leaf.origin = {8 * (n / 169 - 6), 8 * (n / 13 % 13), 8 * (n % 13)};
            for (int v = n % 5; v < kLeafVoxels; v += 40 + n % 37)
                leaf.set(v, static_cast<float>(values(0.1, 2)));
        }
        return volume;
    };
    std::vector<MomentOptions> all(2);
    all[0].block_voxels = 4;
    all[0].soft_steps = 0;
    all[1].budget = 300;
    all[1].soft_steps = 1;
    for (const MomentOptions& options : all) {
        const std::vector<char> free = bytes_of(convert_moments(generated(), options));
        const MemoryLimit limit(64 << 20);
        const Volume volume = generated();
        EXPECT_GT(limit.scratch_bytes(), std::uint64_t{4} << 20);
        EXPECT_EQ(free, bytes_of(convert_moments(volume, options)));
    }
}

}  // namespace
}  // namespace vog
