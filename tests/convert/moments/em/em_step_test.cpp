// em_step_test.cpp: mass and mean of EM steps, ripple of a constant box, voxels outside all
// supports.
#include "convert/moments/em/em_step.h"

#include <gtest/gtest.h>

#include "convert/moments/cells/lattice_field.h"
#include "support/moment_volumes.h"
#include "vog/convert_moments.h"

namespace vog {

using namespace moments;
namespace {

TEST(em_step, voxels_outside_all_supports_are_kept_and_cells_without_voxels_dropped) {
    const Volume volume = test::random_volume(7, 0.3);
    const LatticeField field = lattice_field(volume);
    PackedCells cells(field.bricks);
    // One cell with voxels in reach, one far from all: the first takes the bricks that neither
    // reaches.
    const Vec3d middle = index_box(volume).center();
    cells.push_back({1, middle, {4, 0, 0, 4, 0, 4}});
    cells.push_back({1, middle + Vec3d{1e5, 0, 0}, {4, 0, 0, 4, 0, 4}});
    EmHistory steps;
    EmSolver(field.bricks).step(cells, steps);
    ASSERT_EQ(cells.size(), 1u);
    EXPECT_EQ(steps.momenta.size(), 1u);
    EXPECT_NEAR(cells.mass(0) * voxel_volume(volume) / mass(volume), 1, 1e-6);
}

TEST(em_step, soft_steps_keep_mass_and_mean_and_flatten_a_constant_box) {
    // Hard cells of a constant density ripple; soft ones must do so less, inside.
    test::VolumeMaker maker;
    maker.box({0, 0, 0}, {31, 31, 31}, 1);
    const Volume volume = maker.finish();
    const auto ripple = [&](int steps) {
        MomentOptions options;
        options.block_voxels = 8;
        options.soft_steps = steps;
        const Gaussians model = convert_moments(volume, options);
        EXPECT_NEAR(mass(model) / mass(volume), 1, 1e-5);
        Vec3d mean;
        for (std::size_t i = 0; i < model.size(); ++i)
            mean = mean + (mass(model, i) / mass(model)) * vec_cast<double>(model.mean[i]);
        for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(mean[axis], 15.5, 1e-3);
        double low = 1e9, high = 0;
        for (double y = 12; y < 20; y += 0.5)
            for (double z = 12; z < 20; z += 0.5) {
                double depth = 0;
                for (std::size_t i = 0; i < model.size(); ++i)
                    depth += optical_depth(model, i, {-50, y, z}, {1, 0, 0});
                low = std::min(low, depth), high = std::max(high, depth);
            }
        return (high - low) / 32;
    };
    const double hard = ripple(0), soft = ripple(8);
    EXPECT_GT(hard, 0.1);
    EXPECT_LT(soft, 0.6 * hard);
}

}  // namespace
}  // namespace vog
