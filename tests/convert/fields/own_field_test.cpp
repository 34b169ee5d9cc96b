// own_field_test.cpp: MomentOptions::own_field against add_fields.
#include <gtest/gtest.h>

#include <vector>

#include "support/moment_volumes.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"

namespace vog {
namespace {

/// Whether both have the same Gaussians and the same field, bit for bit.
void expect_same(const Gaussians& a, const Gaussians& b) {
    EXPECT_EQ(a.mean, b.mean);
    EXPECT_EQ(a.scale, b.scale);
    EXPECT_EQ(a.density, b.density);
    ASSERT_EQ(a.fields.scalar.size(), 1u);
    ASSERT_EQ(b.fields.scalar.size(), 1u);
    const ScalarField &x = a.fields.scalar[0], &y = b.fields.scalar[0];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.lower, y.lower);
    EXPECT_EQ(x.upper, y.upper);
    EXPECT_TRUE(x.is_measure && y.is_measure);
    EXPECT_EQ(x.value, y.value);
    EXPECT_EQ(x.gradient, y.gradient);
    EXPECT_EQ(x.deviation, y.deviation);
    EXPECT_EQ(x.skewness, y.skewness);
}

void compare(const Volume& volume, const MomentOptions& options) {
    MomentReport report;
    Gaussians added = convert_moments(volume, options, &report);
    const std::vector<std::vector<VoxelField>> fields{{measure_field(volume, "smoke")}};
    FieldOptions of_cells;
    of_cells.cells = report.cells;
    add_fields(added, std::span(&volume, 1), fields, of_cells);
    MomentOptions carrying = options;
    carrying.own_field = "smoke";
    expect_same(convert_moments(volume, carrying), added);
}

TEST(own_field, is_the_field_of_own_values_of_every_cut) {
    const Volume volume = test::random_volume(41, 0.3);
    for (const int block : {1, 2, 4, 8, 16})
        for (const int steps : {-1, 0, 2}) {
            SCOPED_TRACE(testing::Message() << block << ' ' << steps);
            MomentOptions options;
            options.block_voxels = block, options.soft_steps = steps;
            options.mass_threshold = 0.01;
            compare(volume, options);
        }
    MomentOptions budget;
    budget.budget = 60;
    compare(volume, budget);
}

/// Densities whose sums leave the range of floats are converted in other units; their field is not.
TEST(own_field, has_the_values_of_extreme_densities) {
    Volume volume = test::random_volume(42, 0.3);
    for (Leaf& leaf : volume.leaves)
        for (float& value : leaf.value) value *= 1e-22f;
    for (Tile& tile : volume.tiles) tile.value *= 1e-22f;
    MomentOptions options;
    options.block_voxels = 2;
    compare(volume, options);
}

TEST(own_field, of_levels_is_one_field) {
    const Volume volume = test::random_volume(43, 0.3);
    Composite data;
    data.parts.push_back(volume);
    data.box = world_box(volume), data.voxels = active_voxels(volume);
    MomentOptions options;
    options.block_voxels = 4, options.own_field = "density";
    const Gaussians model = convert_moments(data, options);
    ASSERT_EQ(model.fields.names(), std::vector<std::string>{"density"});
    EXPECT_EQ(model.fields.scalar[0].value.size(), model.size());
}

}  // namespace
}  // namespace vog
