// joint_steps_test.cpp: FieldOptions::joint_field: Gaussians that follow the values of a field.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "support/moment_volumes.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/progress.h"

namespace vog {
namespace {

/// A slab of values 1 beside one of 5; the surface between them lies across the cells of 8 voxels.
Volume two_materials() {
    test::VolumeMaker maker;
    maker.box({0, 0, 0}, {18, 15, 15}, 1);
    maker.box({19, 0, 0}, {31, 15, 15}, 5);
    return maker.finish();
}

Gaussians cells_of_8(const Volume& volume) {
    MomentOptions options;
    options.block_voxels = 8, options.soft_steps = 0, options.mass_threshold = 0;
    return convert_moments(volume, options);
}

void fit(Gaussians& model, const Volume& volume, const FieldOptions& options) {
    const std::vector<std::vector<VoxelField>> fields{{measure_field(volume, "density")}};
    add_fields(model, std::span(&volume, 1), fields, options);
}

/// Root mean square residual, weighted by mass.
double residual(const Gaussians& model) {
    double sum = 0;
    for (std::size_t i = 0; i < model.size(); ++i)
        sum += mass(model, i) * std::pow(double{model.fields.scalar[0].deviation[i]}, 2);
    return std::sqrt(sum / mass(model));
}

/// Sum over Gaussians of mass times value.
double weighted(const Gaussians& model) {
    double sum = 0;
    for (std::size_t i = 0; i < model.size(); ++i)
        sum += mass(model, i) * double{model.fields.scalar[0].value[i]};
    return sum;
}

TEST(joint_steps, part_two_materials_at_their_surface) {
    const Volume volume = two_materials();
    Gaussians before = cells_of_8(volume), after = before;
    fit(before, volume, {});
    FieldOptions options;
    options.joint_field = "density", options.joint_steps = 8;
    fit(after, volume, options);
    EXPECT_LT(residual(after), 0.5 * residual(before));
    // Each Gaussian near the surface has one of the two values, not their mean.
    std::size_t mixed = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
        const double value = after.fields.scalar[0].value[i];
        mixed += value > 1.5 && value < 4.5;
    }
    EXPECT_EQ(mixed, 0u);
}

TEST(joint_steps, conserve_mass_center_and_weighted_values) {
    const Volume volume = test::random_volume(51, 0.3);
    for (const int steps : {1, 3}) {
        Gaussians model = cells_of_8(volume);
        const double all = mass(model);
        Vec3d center;
        for (std::size_t i = 0; i < model.size(); ++i)
            center = center + mass(model, i) * world_mean(model, i);
        double squares = 0;
        for (const Leaf& leaf : volume.leaves)
            for (const float value : leaf.value) squares += double{value} * double{value};
        for (const Tile& tile : volume.tiles)
            squares += double{tile.value} * double{tile.value} * std::pow(tile.edge, 3);
        squares *= voxel_volume(volume);
        FieldOptions options;
        options.joint_field = "volume", options.joint_steps = steps;
        fit(model, volume, options);
        Vec3d moved;
        for (std::size_t i = 0; i < model.size(); ++i)
            moved = moved + mass(model, i) * world_mean(model, i);
        // Sums of floats over samples: 1e-5 of the whole.
        EXPECT_NEAR(mass(model), all, 1e-5 * all);
        EXPECT_LT(length(moved - center), 1e-5 * all * world_box(volume).radius());
        EXPECT_NEAR(weighted(model), squares, 1e-5 * squares);
    }
}

TEST(joint_steps, of_a_constant_field_are_steps_of_position_alone) {
    const Volume volume = two_materials();
    VoxelField constant;
    constant.name = "one", constant.lower = constant.upper = 1;
    VoxelValues values;
    for (std::size_t l = 0; l < volume.leaves.size(); ++l) values.leaf.emplace_back().fill(1);
    constant.component.push_back(values);
    const std::vector<std::vector<VoxelField>> fields{{constant}};
    MomentOptions soft;
    soft.block_voxels = 8, soft.soft_steps = 1, soft.mass_threshold = 0;
    const Gaussians expected = convert_moments(volume, soft);
    Gaussians model = cells_of_8(volume);
    FieldOptions options;
    options.joint_field = "one", options.joint_steps = 1;
    add_fields(model, std::span(&volume, 1), fields, options);
    ASSERT_EQ(model.size(), expected.size());
    for (std::size_t i = 0; i < model.size(); ++i) {
        EXPECT_LT(length(vec_cast<double>(model.mean[i] - expected.mean[i])), 1e-3);
        EXPECT_NEAR(model.density[i], expected.density[i], 1e-3 * expected.density[i]);
    }
}

TEST(joint_steps, report_the_errors_of_depth) {
    const Volume volume = two_materials();
    Gaussians model = cells_of_8(volume);
    JointReport report;
    FieldOptions options;
    options.joint_field = "density", options.joint_report = &report;
    fit(model, volume, options);
    EXPECT_GT(report.error_before, 0);
    EXPECT_GT(report.error_after, 0);
    EXPECT_NE(report.error_before, report.error_after);
    MomentOptions measured;
    measured.block_voxels = 8, measured.soft_steps = 0, measured.mass_threshold = 0;
    measured.measure = true;
    MomentReport of_cells;
    (void)convert_moments(volume, measured, &of_cells);
    EXPECT_NEAR(report.error_before, of_cells.measured_error, 1e-6);
}

TEST(joint_steps, any_number_of_threads_gives_the_same_bytes) {
    const Volume volume = test::random_volume(52, 0.2);
    const Gaussians model = cells_of_8(volume);
    Gaussians one;
    for (const int threads : {1, 2, 3, 8}) {
        const ThreadLimit limit(threads);
        Gaussians made = model;
        FieldOptions options;
        options.joint_field = "density";
        fit(made, volume, options);
        if (threads == 1) one = made;
        EXPECT_EQ(one.mean, made.mean);
        EXPECT_EQ(one.scale, made.scale);
        EXPECT_EQ(one.density, made.density);
        EXPECT_EQ(one.fields.scalar[0].deviation, made.fields.scalar[0].deviation);
    }
}

/// Levels are one model; a vector's components count together.
TEST(joint_steps, take_levels_and_vectors) {
    const Volume volume = test::random_volume(53, 0.3);
    Volume fine = volume;
    for (Vec3d& row : fine.world_from_index.linear.row) row = 0.5 * row;
    fine.world_from_index.translation = Vec3d{1000, 0, 0};
    const std::vector<Volume> levels{volume, fine};
    const auto vector_of = [](const Volume& of) {
        VoxelField field;
        field.name = "velocity", field.upper = 3;
        for (const float sign : {1.0f, -1.0f, 0.5f}) {
            VoxelValues& values = field.component.emplace_back();
            for (const Leaf& leaf : of.leaves) {
                auto& to = values.leaf.emplace_back();
                for (std::size_t n = 0; n < to.size(); ++n)
                    to[n] = sign * std::sin(static_cast<float>(n) + leaf.value[n]);
            }
            values.tile.assign(of.tiles.size(), sign);
        }
        return field;
    };
    const std::vector<std::vector<VoxelField>> fields{{vector_of(volume), vector_of(fine)}};
    Gaussians model = cells_of_8(volume);
    append(model, cells_of_8(fine));
    const double all = mass(model);
    FieldOptions options;
    options.joint_field = "velocity";
    add_fields(model, levels, fields, options);
    ASSERT_EQ(model.fields.vector.size(), 1u);
    EXPECT_NEAR(mass(model), all, 1e-5 * all);
    validate(model);
}

TEST(joint_steps, refuse_what_they_cannot_do) {
    const Volume volume = two_materials();
    const auto refused = [&](const FieldOptions& options) {
        Gaussians model = cells_of_8(volume);
        try {
            fit(model, volume, options);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    FieldOptions unknown;
    unknown.joint_field = "heat";
    EXPECT_EQ(refused(unknown), "no field 'heat' to fit the Gaussians to (there are: density)");
    FieldOptions none;
    none.joint_field = "density", none.joint_steps = 0;
    EXPECT_EQ(refused(none), "0 joint steps, expected 1 to 1000");
}

}  // namespace
}  // namespace vog
