// extreme_values_test.cpp: densities near the ends of the range of floats, and voxels far apart.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "convert/moments/mass_threshold.h"
#include "render/splat/splat.h"
#include "support/moment_volumes.h"
#include "support/scenes.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/sample.h"

namespace vog {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();

MomentOptions options_of(int block, std::size_t budget) {
    MomentOptions options;
    options.block_voxels = block;
    options.budget = budget;
    return options;
}

Volume scaled(Volume volume, int exponent) {
    for (Leaf& leaf : volume.leaves)
        for (float& value : leaf.value) value = std::ldexp(value, exponent);
    for (Tile& tile : volume.tiles) tile.value = std::ldexp(tile.value, exponent);
    return volume;
}

/// Powers of two change no digit of a model but its densities.
TEST(extreme_values, densities_of_any_size_give_the_same_gaussians) {
    const Volume volume = test::random_volume(11, 0.1);
    for (const auto& [block, budget] : std::vector<std::pair<int, std::size_t>>{
             {1, 0}, {2, 0}, {8, 0}, {32, 0}, {0, 500}, {0, 0}}) {
        MomentReport report;
        const Gaussians model = convert_moments(volume, options_of(block, budget), &report);
        for (const int exponent : {-100, -40, 70, 118}) {
            MomentReport scaled_report;
            const Gaussians other = convert_moments(scaled(volume, exponent),
                                                    options_of(block, budget), &scaled_report);
            EXPECT_EQ(other.mean, model.mean) << block << ' ' << budget << ' ' << exponent;
            EXPECT_EQ(other.scale, model.scale);
            EXPECT_EQ(other.options, model.options);
            ASSERT_EQ(other.size(), model.size());
            for (std::size_t i = 0; i < model.size(); ++i)
                ASSERT_EQ(other.density[i], std::ldexp(model.density[i], exponent));
            EXPECT_EQ(scaled_report.mass_ratio, report.mass_ratio);
            EXPECT_EQ(scaled_report.measured_error, report.measured_error);
        }
    }
}

TEST(extreme_values, voxels_near_the_largest_float_keep_their_mass) {
    test::VolumeMaker maker;
    maker.box({0, 0, 0}, {7, 7, 7}, kLargest / 2);
    const Volume volume = maker.finish();
    for (const int block : {2, 4, 8, 128}) {
        MomentReport report;
        const Gaussians model = convert_moments(volume, options_of(block, 0), &report);
        EXPECT_NEAR(mass(model) / mass(volume), 1, 1e-5) << block;
        EXPECT_NEAR(report.mass_ratio, 1, 1e-5) << block;
    }
    MomentReport report;
    EXPECT_GT(convert_moments(volume, options_of(0, 10), &report).size(), 1u);
    EXPECT_NEAR(report.mass_ratio, 1, 1e-5);
}

TEST(extreme_values, a_density_beyond_floats_is_refused_with_its_place) {
    test::VolumeMaker maker;
    maker.set({70, 0, 0}, kLargest);  // the peak of its Gaussian is higher
    Volume volume = maker.finish();
    volume.source = "one.vdb";
    try {
        (void)convert_moments(volume, options_of(1, 0));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).rfind("one.vdb: the Gaussian at 70 0 0", 0), 0u)
            << error.what();
    }
}

TEST(extreme_values, a_place_beyond_floats_is_refused_by_name) {
    test::VolumeMaker maker;
    maker.set({1, 0, 0}, 1);
    Volume volume = maker.finish();
    volume.source = "one.vdb";
    volume.world_from_index.linear.row[0].x = 1e39;
    try {
        (void)convert_moments(volume);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).rfind("one.vdb: reaches 7.5e+39 world units", 0), 0u)
            << error.what();
    }
}

TEST(extreme_values, masses_beyond_floats_stay_in_the_histogram) {
    for (const float mass : {std::numeric_limits<float>::infinity(), -1.0f, -0.0f,
                             std::numeric_limits<float>::quiet_NaN()}) {
        moments::MassThreshold threshold;
        for (int n = 0; n < 1000; ++n) threshold.add(mass);
        if (std::isfinite(mass)) continue;
        EXPECT_THROW((void)threshold.least_mass(0.5), Error) << mass;
    }
}

Volume cube_of_voxels(const std::vector<Vec3i>& origins, int edge) {
    test::VolumeMaker maker;
    for (const Vec3i at : origins) maker.box(at, at + Vec3i{edge - 1, edge - 1, edge - 1}, 1);
    return maker.finish();
}

/// Relative L2 of T of the views of `alone`, a part of the data that lies far from the rest.
TEST(extreme_values, clouds_far_apart_are_measured_where_they_are) {
    const Volume two = cube_of_voxels({{0, 0, 0}, {1000000, 0, 0}}, 24);
    const Volume one = cube_of_voxels({{0, 0, 0}}, 24);
    MomentOptions options = options_of(8, 0);
    options.measure = true;
    MomentReport both, alone;
    (void)convert_moments(two, options, &both);
    (void)convert_moments(one, options, &alone);
    EXPECT_NEAR(both.measured_error, alone.measured_error, 0.05);
    EXPECT_NE(both.view_note.find("heaviest 2 of 2 blocks"), std::string::npos) << both.view_note;
    EXPECT_EQ(alone.view_note, "");
    // One Gaussian for both has nothing where they are.
    options = options_of(0, 1);
    options.measure = true;
    (void)convert_moments(two, options, &both);
    EXPECT_GT(both.measured_error, 0.9);
}

/// Scattered voxels have more than a thousandth of the mass, so that the box of the mass is wide.
TEST(extreme_values, a_cloud_among_scattered_voxels_is_measured) {
    std::vector<Vec3i> origins;
    test::VolumeMaker maker;
    maker.box({0, 0, 0}, {23, 23, 23}, 1);
    for (int n = 1; n < 100; ++n) maker.set({n * 7777, n * 3333, n * -5555}, 1);
    MomentReport report;
    const Gaussians model = convert_moments(maker.finish(), {}, &report);
    EXPECT_GT(model.size(), 100u);
    EXPECT_GT(report.measured_error, 0.001);
    EXPECT_LT(report.measured_error, 0.5);
    EXPECT_NE(report.view_note.find("% of the mass"), std::string::npos);
}

TEST(extreme_values, a_stray_voxel_is_reported) {
    Volume volume = sample_cloud({.size = 64});
    volume.leaves.emplace_back().origin = {100000, 0, 0};
    volume.leaves.back().set(0, 0.001f);
    MomentReport report;
    (void)convert_moments(volume, {}, &report);
    EXPECT_NE(report.view_note.find("far outside"), std::string::npos) << report.view_note;
}

/// Cells of scattered voxels overlap many others' bricks; the finest cut of them is exact.
TEST(extreme_values, scattered_voxels_keep_mass_and_budget) {
    for (const double range : {3000.0, 1e9}) {
        test::Random random(5);
        test::VolumeMaker maker;
        for (int n = 0; n < 2000; ++n) {
            const auto at = [&] { return static_cast<int>(random(-range, range)); };
            maker.set({at(), at(), at()}, 1);
        }
        const Volume volume = maker.finish();
        MomentReport report;
        const Gaussians model = convert_moments(volume, options_of(0, 500), &report);
        EXPECT_LE(model.size(), 500u);
        EXPECT_NEAR(report.mass_ratio, 1, 1e-4);
    }
}

}  // namespace
}  // namespace vog
