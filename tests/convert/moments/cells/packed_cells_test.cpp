// packed_cells_test.cpp: precision of packed cells, and the Gaussians made from them.
#include "convert/moments/cells/packed_cells.h"

#include <gtest/gtest.h>

namespace vog {

using namespace moments;
namespace {

constexpr double kFloatRounding = 6e-8;  // a float's rounding

Moments cell_at(Vec3d mean) { return {3.3, mean, {1.7, 0.3, -0.2, 2.9, 0.5, 4.1}}; }

TEST(packed_cells, moments_come_back_in_floats_wherever_the_bricks_are) {
    constexpr std::int32_t kFar = 8 << 20;
    const std::vector<Brick> bricks{{{kFar, kFar, -kFar}}, {{kFar + 64, kFar + 8, -kFar + 16}}};
    PackedCells cells(bricks);
    const Moments cell = cell_at({kFar + 1.37, kFar + 2.61, -kFar + 3.14});
    cells.push_back(cell);
    const Moments back = cells[0];
    EXPECT_NEAR(back.mass, cell.mass, kFloatRounding * cell.mass);
    // From the middle of the bricks, which is at most 50 voxels away.
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(back.mean[axis], cell.mean[axis], 50 * kFloatRounding);
    for (std::size_t n = 0; n < 6; ++n)
        EXPECT_NEAR(back.covariance[n], cell.covariance[n], 5 * kFloatRounding);
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

}  // namespace
}  // namespace vog
