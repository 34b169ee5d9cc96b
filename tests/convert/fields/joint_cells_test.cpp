// joint_cells_test.cpp: moments of position and value through splits and merges.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "convert/fields/joint/joint_cells.h"
#include "support/moment_volumes.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"

namespace vog {

using namespace joint;
namespace {

/// Mass, and first and second moments of position and value, of all cells.
std::array<double, 15> moments_of_all(const JointCells& cells) {
    std::array<double, 15> sums{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto& [m, plane] = cells[i];
        const auto& c = m.covariance;
        const Vec3d g = plane.plane.gradient;
        const Vec3d with{c[0] * g.x + c[1] * g.y + c[2] * g.z, c[1] * g.x + c[3] * g.y + c[4] * g.z,
                         c[2] * g.x + c[4] * g.y + c[5] * g.z};
        const double value = plane.plane.value;
        sums[0] += m.mass;
        std::size_t n = 1, entry = 0;
        for (int row = 0; row < 3; ++row) {
            sums[n++] += m.mass * m.mean[row];
            sums[n++] += m.mass * (with[row] + m.mean[row] * value);
            for (int column = row; column < 3; ++column)
                sums[n++] += m.mass * (c[entry++] + m.mean[row] * m.mean[column]);
        }
        sums[n++] += m.mass * value;
        sums[n++] += m.mass * (dot(g, with) + plane.variance + value * value);
    }
    return sums;
}

TEST(joint_cells, keep_the_moments_of_position_and_value) {
    const Volume volume = test::random_volume(54, 0.3);
    MomentOptions options;
    options.block_voxels = 4, options.soft_steps = 0, options.mass_threshold = 0;
    Gaussians model = convert_moments(volume, options);
    const std::vector<std::vector<VoxelField>> fields{{measure_field(volume, "density")}};
    add_fields(model, {&volume, 1}, fields);
    const Layout layout(fields);
    std::vector<float> error(model.size());
    for (std::size_t i = 0; i < error.size(); ++i)
        error[i] = static_cast<float>(i * 7919 % error.size());
    for (const SplitAlong along : {SplitAlong::gradient, SplitAlong::longest_axis}) {
        JointCells cells(model, model.fields.scalar[0], layout.parts[0]);
        const auto before = moments_of_all(cells);
        const JointCells whole = cells;
        cells.split_and_merge(error, 0.2, along);
        ASSERT_EQ(cells.size(), model.size());
        const auto after = moments_of_all(cells);
        for (std::size_t n = 0; n < before.size(); ++n)
            EXPECT_NEAR(after[n], before[n], 1e-9 * std::abs(before[n]) + 1e-9 * before[0]) << n;
        // The halves of the worst differ most in value along the gradient: by sqrt(8 / pi) standard deviations of
        // the plane's values.
        const auto least = static_cast<float>(error.size() - error.size() / 5);
        std::size_t parted = 0;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (error[i] < least) continue;
            const auto& c = whole[i].moments.covariance;
            const Vec3d g = whole[i].value.plane.gradient;
            const double variance = g.x * g.x * c[0] + g.y * g.y * c[3] + g.z * g.z * c[5] +
                                    2 * (g.x * g.y * c[1] + g.x * g.z * c[2] + g.y * g.z * c[4]);
            EXPECT_NEAR(cells[i].moments.mass, 0.5 * whole[i].moments.mass,
                        1e-9 * whole[i].moments.mass);
            if (variance < 1e-6) continue;  // of a single voxel: no plane
            ++parted;
            const double moved = std::abs(cells[i].value.plane.value - whole[i].value.plane.value);
            const double most = std::sqrt(2 * variance / std::numbers::pi);
            if (along == SplitAlong::gradient)
                EXPECT_NEAR(moved, most, 1e-6 * most);
            else
                EXPECT_LE(moved, most * (1 + 1e-6));
        }
        EXPECT_GT(parted, 10u);
    }
}

TEST(joint_cells, are_the_models_gaussians) {
    const Volume volume = test::random_volume(55, 0.3);
    MomentOptions options;
    options.block_voxels = 4, options.mass_threshold = 0;
    Gaussians model = convert_moments(volume, options);
    const std::vector<std::vector<VoxelField>> fields{{measure_field(volume, "density")}};
    add_fields(model, {&volume, 1}, fields);
    const Layout layout(fields);
    const JointCells cells(model, model.fields.scalar[0], layout.parts[0]);
    const Gaussians same = cells.to_gaussians(model);
    ASSERT_EQ(same.size(), model.size());
    EXPECT_TRUE(same.fields.empty());
    EXPECT_EQ(same.source, model.source);
    EXPECT_EQ(same.options, model.options);
    const double unit{layout.parts[0].unit};
    for (std::size_t i = 0; i < model.size(); ++i) {
        EXPECT_NEAR(mass(same, i) / mass(model, i), 1, 1e-4);
        EXPECT_LT(length(world_mean(same, i) - world_mean(model, i)), 1e-5);
        EXPECT_NEAR(double{layout.parts[0].reference} + unit * cells.distributions()[i].plane.value,
                    double{model.fields.scalar[0].value[i]}, 1e-6 * unit);
    }
}

}  // namespace
}  // namespace vog
