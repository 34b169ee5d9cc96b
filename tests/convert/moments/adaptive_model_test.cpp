// adaptive_model_test.cpp: counts of budgets and measured errors of searches.
#include <gtest/gtest.h>

#include <cmath>

#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "support/data.h"
#include "support/moment_volumes.h"
#include "vog/convert_moments.h"
#include "vog/volume_io.h"

namespace vog {
namespace {

TEST(adaptive_model, a_larger_budget_is_used_and_never_exceeded) {
    const Volume volume = test::random_volume(24, 0.05);
    std::size_t last = 0;
    for (std::size_t budget = 1; budget < 20000; budget = 2 * budget + 1) {
        MomentOptions options;
        options.budget = budget;
        options.soft_steps = 0;
        const std::size_t count = convert_moments(volume, options).size();
        EXPECT_LE(count, budget);
        EXPECT_GE(count, last);
        if (budget < 1000) {
            EXPECT_GE(10 * (count + 8), 9 * budget);
        }
        last = count;
    }
}

TEST(adaptive_model, the_requested_error_holds_in_other_views_of_real_data) {
    VOG_NEEDS_DATA("fire.vdb");
    VdbOptions grid;
    grid.grid = "flames";
    const Volume volume = read_vdb(test::data_dir() / "fire.vdb", grid);
    MomentOptions options;
    options.error = 0.2;
    MomentReport report;
    const Gaussians model = convert_moments(volume, options, &report);
    EXPECT_LE(report.measured_error, options.error);
    EXPECT_GT(report.measured_error, 0.8 * options.error);  // the smallest cut, not just any
    EXPECT_NE(model.options.find("measured error"), std::string::npos);
    const std::vector<VoxelGrid> grids{voxel_grid(volume)};
    double error2 = 0, norm2 = 0;
    for (int view = 0; view < 3; ++view) {
        const Camera camera = orbit_view(model.box, {63.0 + 115 * view, 34.0 - 29 * view, 2.5, 45});
        const DepthImage exact = render_reference(grids, camera, 160, 160);
        const DepthImage image = render_splat(model, camera, 160, 160);
        for (std::size_t n = 0; n < exact.depth.size(); ++n) {
            error2 += std::pow(double{image.depth[n]} - exact.depth[n], 2);
            norm2 += std::pow(double{exact.depth[n]}, 2);
        }
    }
    EXPECT_LT(std::sqrt(error2 / norm2), 1.2 * options.error);
}

TEST(adaptive_model, an_error_out_of_reach_gives_the_finest_cut_and_says_so) {
    test::VolumeMaker maker;
    maker.set({0, 0, 0}, 1);
    maker.set({3, 0, 0}, 2);
    MomentReport report;
    MomentOptions options;
    options.error = 1e-6;
    const Gaussians model = convert_moments(maker.finish(), options, &report);
    EXPECT_EQ(model.size(), 2u);
    EXPECT_GT(report.measured_error, options.error);
}

}  // namespace
}  // namespace vog
