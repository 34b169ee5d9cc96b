// em_step_test.cpp: mass and mean of EM steps, ripple of a constant box, voxels outside all
// supports.
#include "convert/moments/em/em_step.h"

#include <gtest/gtest.h>

#include "convert/moments/cells/lattice_field.h"
#include "convert/moments/cells/octree.h"
#include "render/splat/splat.h"
#include "support/moment_volumes.h"
#include "support/scenes.h"
#include "vog/convert_moments.h"

namespace vog {

using namespace moments;
namespace {

TEST(em_step, voxels_outside_all_supports_are_kept_and_cells_without_voxels_dropped) {
    const Volume volume = test::random_volume(7, 0.3);
    const LatticeField field = lattice_field(volume);
    PackedCells cells(field.bricks);
    // One cell amid the voxels, one far from all. Voxels outside both supports go to the nearest
    // cell, the first.
    const Vec3d middle = index_box(volume).center();
    cells.push_back({1, middle, {4, 0, 0, 4, 0, 4}});
    cells.push_back({1, middle + Vec3d{1e5, 0, 0}, {4, 0, 0, 4, 0, 4}});
    EmHistory history;
    EmSolver(field.bricks).step(cells, history);
    ASSERT_EQ(cells.size(), 1u);
    EXPECT_EQ(history.momenta.size(), 1u);
    EXPECT_NEAR(cells.mass(0) * voxel_volume(volume) / mass(volume), 1, 1e-6);
}

/// Voxels along an oblique line make a needle, whose quadratic form is lost to rounding far from its mean.
TEST(em_step, needles_of_millions_of_voxels_keep_their_mass) {
    test::VolumeMaker maker;
    test::Random random(3);
    for (int n = 0; n < 40; ++n) {
        const double at = random(-1, 1);
        maker.set({static_cast<int>(2e6 * at), static_cast<int>(1.4e6 * at),
                   static_cast<int>(-0.9e6 * at)},
                  1);
    }
    const Volume volume = maker.finish();
    const LatticeField field = lattice_field(volume);
    const MomentOctree octree = brick_octree(field.bricks);
    const Moments all = cell_moments(octree.levels.back().cells[0], octree.levels.back().edge_log2);
    PackedCells cells(field.bricks);
    cells.push_back(all);
    EmHistory history;
    EmSolver(field.bricks).step(cells, history);
    ASSERT_EQ(cells.size(), 1u);
    EXPECT_NEAR(cells.mass(0) / all.mass, 1, 1e-6);
}

/// Alone, a Gaussian has responsibility 1 everywhere, so a step gives it the moments of all voxels.
TEST(em_step, a_single_cell_gets_the_moments_of_all_voxels) {
    const Volume volume = test::random_volume(8, 0.1);
    const LatticeField field = lattice_field(volume);
    const MomentOctree octree = brick_octree(field.bricks);
    const Moments all = cell_moments(octree.levels.back().cells[0], octree.levels.back().edge_log2);
    PackedCells cells(field.bricks);
    cells.push_back({1, index_box(volume).center() + Vec3d{3, -2, 1}, {90, 5, 0, 70, -8, 60}});
    EmHistory history;
    EmSolver(field.bricks).step(cells, history);
    ASSERT_EQ(cells.size(), 1u);
    const Moments one = cells[0];
    constexpr double kFloat = 1e-5;  // float32 sums of each brick
    const double extent = index_box(volume).radius();
    EXPECT_NEAR(one.mass / all.mass, 1, kFloat);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(one.mean[axis], all.mean[axis], kFloat * extent);
    for (std::size_t n = 0; n < 6; ++n)
        EXPECT_NEAR(one.covariance[n], all.covariance[n], kFloat * extent * extent);
}

TEST(em_step, mass_and_mean_are_kept_and_a_constant_box_ripples_less) {
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
