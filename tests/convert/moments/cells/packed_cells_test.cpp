// packed_cells_test.cpp: cells as floats, the models they become, and soft steps over them.
#include "convert/moments/cells/packed_cells.h"

#include <gtest/gtest.h>

#include "compare/error_views.h"
#include "convert/moments/cells/lattice_field.h"
#include "convert/moments/em/em_step.h"
#include "support/moment_volumes.h"
#include "vog/convert_moments.h"

namespace vog {

using namespace comparison;
using namespace moments;
namespace {

constexpr double kFloat = 6e-8;  // a float's rounding

Moments cell_at(Vec3d mean) { return {3.3, mean, {1.7, 0.3, -0.2, 2.9, 0.5, 4.1}}; }

TEST(packed_cells, moments_come_back_in_floats_wherever_the_bricks_are) {
    constexpr std::int32_t kFar = 8 << 20;
    const std::vector<Brick> bricks{{{kFar, kFar, -kFar}}, {{kFar + 64, kFar + 8, -kFar + 16}}};
    PackedCells cells(bricks);
    const Moments cell = cell_at({kFar + 1.37, kFar + 2.61, -kFar + 3.14});
    cells.push_back(cell);
    const Moments back = cells[0];
    EXPECT_NEAR(back.mass, cell.mass, kFloat * cell.mass);
    // From the middle of the bricks, which is at most 50 voxels away.
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(back.mean[axis], cell.mean[axis], 50 * kFloat);
    for (std::size_t n = 0; n < 6; ++n)
        EXPECT_NEAR(back.covariance[n], cell.covariance[n], 5 * kFloat);
}

TEST(packed_cells, those_kept_become_gaussians_in_their_order) {
    const std::vector<Brick> bricks{{{0, 0, 0}}};
    PackedCells cells(bricks);
    for (int n = 0; n < 10; ++n) cells.push_back(cell_at({double(n), 0, 0}));
    cells.keep_if([](std::size_t i) { return i % 3 == 0; });
    ASSERT_EQ(cells.size(), 4u);
    for (const bool axis_aligned : {false, true}) {
        const MomentFrame frame = moment_frame({}, axis_aligned, 1);
        Gaussians expected;
        resize(expected, 4, axis_aligned);
        for (std::size_t i = 0; i < 4; ++i) set_gaussian(expected, i, cells[i], frame);
        const Gaussians model = PackedCells(cells).to_gaussians(frame);
        EXPECT_EQ(model.mean, expected.mean);
        EXPECT_EQ(model.scale, expected.scale);
        EXPECT_EQ(model.rotation, expected.rotation);
        EXPECT_EQ(model.density, expected.density);
    }
}

TEST(packed_cells, soft_steps_lose_no_voxel_out_of_reach_and_keep_no_cell_without_any) {
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
    EXPECT_EQ(steps.ways.size(), 1u);
    EXPECT_NEAR(cells.mass(0) * voxel_volume(volume) / mass(volume), 1, 1e-6);
}

TEST(moment_error, rows_keep_all_but_their_empty_ends) {
    DepthImage image(5, 3);
    image.at(1, 0) = 2, image.at(3, 0) = 1, image.at(4, 2) = 3;
    const CroppedDepth cropped(image);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) EXPECT_EQ(cropped.at(x, y), image.at(x, y));
}

}  // namespace
}  // namespace vog
