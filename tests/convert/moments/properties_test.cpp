// properties_test.cpp: mass, counts and errors for random volumes and all cuts.
#include <gtest/gtest.h>

#include <cmath>

#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "support/moment_volumes.h"
#include "vog/convert_moments.h"
#include "vog/sample.h"

namespace vog {
namespace {

// Masses are float32 in the model and summed over at most some ten thousand cells.
constexpr double kMassTolerance = 1e-5;

MomentOptions cut(int block, std::size_t budget, int soft_steps) {
    MomentOptions options;
    options.block_voxels = block;
    options.budget = budget;
    options.soft_steps = soft_steps;
    return options;
}

TEST(moment_properties, mass_is_conserved_for_random_grids_and_all_cuts) {
    for (const std::uint64_t seed : {101, 102, 103, 104}) {
        const Volume volume = test::random_volume(seed, 0.002 * std::pow(4, double(seed - 101)));
        std::vector<MomentOptions> all;
        for (const int edge : {1, 4, 32}) all.push_back(cut(edge, 0, seed & 1 ? 0 : 3));
        for (const std::size_t budget : {3, 90, 1000}) all.push_back(cut(0, budget, 5));
        all.emplace_back();
        all.back().error = 0.2;
        for (MomentOptions options : all)
            for (const double threshold : {0.0, 1e-3}) {
                options.mass_threshold = threshold;
                MomentReport report;
                const Gaussians model = convert_moments(volume, options, &report);
                EXPECT_NEAR(report.mass_ratio, 1, kMassTolerance) << seed << model.options;
                EXPECT_LE(report.dropped_mass_share, threshold);
                EXPECT_NEAR(mass(model) / mass(volume), 1 - report.dropped_mass_share,
                            kMassTolerance)
                    << seed << model.options;
            }
    }
}

TEST(moment_properties, a_budget_is_never_exceeded_soft_or_hard) {
    for (const std::uint64_t seed : {111, 112, 113}) {
        const Volume volume = test::random_volume(seed, 0.03);
        for (std::size_t budget = 1; budget < 5000; budget = 3 * budget + seed % 3)
            for (const int steps : {0, 2})
                EXPECT_LE(convert_moments(volume, cut(0, budget, steps)).size(), budget);
    }
}

/// Relative L2 of T over five views other than those of the search.
double other_error(const Volume& volume, const Gaussians& model) {
    const std::vector<VoxelGrid> grids{voxel_grid(volume)};
    double error2 = 0, norm2 = 0;
    for (int view = 0; view < 5; ++view) {
        const Camera camera =
            orbit_view(model.box, {50.0 + 75 * view, 40.0 - 20 * view, 2.4 + 0.3 * view, 42});
        const DepthImage exact = render_reference(grids, camera, 150, 150);
        const DepthImage image = render_splat(model, camera, 150, 150);
        for (std::size_t n = 0; n < exact.depth.size(); ++n) {
            error2 += std::pow(double{image.depth[n]} - exact.depth[n], 2);
            norm2 += std::pow(double{exact.depth[n]}, 2);
        }
    }
    return std::sqrt(error2 / norm2);
}

TEST(moment_properties, an_error_holds_from_other_sides) {
    // Below, the faces of these few voxels are in the way, which line up along the axes.
    for (const double target : {0.2, 0.12}) {
        for (const Volume& volume : {sample_cloud({.size = 64}), sample_explosion({.size = 64})}) {
            MomentOptions options;
            options.error = target;
            MomentReport report;
            const Gaussians model = convert_moments(volume, options, &report);
            EXPECT_LE(report.measured_error, target);
            EXPECT_LE(other_error(volume, model), 1.15 * report.measured_error);
            EXPECT_LT(report.mean_error, report.measured_error);
        }
    }
}

TEST(moment_properties, densities_of_any_magnitude_give_the_same_shapes) {
    // Cosmology writes 1e-30 g/cm³, counts go to 1e9: the unit must not matter, nor overflow.
    const Volume volume = test::random_volume(121, 0.03);
    const Gaussians model = convert_moments(volume, cut(4, 0, 3));
    for (const float unit : {0x1p-90f, 0x1p60f}) {
        Volume scaled = volume;
        for (Leaf& leaf : scaled.leaves)
            for (float& value : leaf.value) value *= unit;
        for (Tile& tile : scaled.tiles) tile.value *= unit;
        const Gaussians same = convert_moments(scaled, cut(4, 0, 3));
        ASSERT_EQ(same.size(), model.size());
        EXPECT_EQ(same.mean, model.mean);
        EXPECT_EQ(same.scale, model.scale);
        EXPECT_NEAR(mass(same) / mass(model) / double{unit}, 1, 1e-6);
    }
}

}  // namespace
}  // namespace vog
