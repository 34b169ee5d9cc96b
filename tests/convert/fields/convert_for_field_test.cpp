// convert_for_field_test.cpp: models whose number and refinement follow errors of pictures by value.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "compare/error_views.h"
#include "compare/values/value_views.h"
#include "convert/fields/joint/value_rounds.h"
#include "support/moment_volumes.h"
#include "support/refusal.h"
#include "vog/convert_fields.h"
#include "vog/error.h"

namespace vog {
namespace {

/// A ball of values 5 in one of values 1: surfaces across cells of any size.
Volume two_balls() {
    test::VolumeMaker maker;
    for (int x = -12; x < 12; ++x)
        for (int y = -12; y < 12; ++y)
            for (int z = -12; z < 12; ++z) {
                const Vec3d at{x + 0.5, y + 0.5, z + 0.5};
                const double r2 = dot(at, at),
                             inner2 = dot(at - Vec3d{2, 1, 0}, at - Vec3d{2, 1, 0});
                if (r2 < 140) maker.set({x, y, z}, inner2 < 40 ? 5 : 1);
            }
    Volume volume = maker.finish();
    volume.source = "balls.vdb", volume.name = "density";
    return volume;
}

std::vector<std::vector<VoxelField>> own_values(const Volume& volume) {
    return {{measure_field(volume, "density")}};
}

struct Made {
    Gaussians model;
    JointReport joint;
};
Made made(const Volume& volume, const MomentOptions& moments) {
    Made result;
    FieldOptions options;
    options.joint_field = "volume", options.joint_report = &result.joint;
    result.model = convert_for_field(volume, own_values(volume), moments, options);
    return result;
}

TEST(convert_for_field, an_error_by_value_is_met_by_the_fewest) {
    const Volume volume = two_balls();
    MomentOptions moments;
    moments.error = 0.3;
    const Made found = made(volume, moments);
    EXPECT_LE(found.joint.value_error, 0.3);
    EXPECT_GT(found.joint.value_error, 0);
    EXPECT_NEAR(mass(found.model), mass(volume), 1e-4 * mass(volume));
    // A fifth fewer miss it, by the same steps.
    moments.error = 0, moments.budget = found.model.size() * 4 / 5;
    moments.soft_steps = kSearchSoftSteps;
    moments.refine_seconds = 1e-9;  // measured, and no round
    EXPECT_GT(made(volume, moments).joint.value_error, 0.3);
    // Errors by value are not those of T.
    moments.budget = found.model.size();
    const Made again = made(volume, moments);
    EXPECT_NEAR(again.joint.value_error, found.joint.value_error, 0.03);
    EXPECT_LT(again.joint.error_after, 0.5 * again.joint.value_error);
}

TEST(convert_for_field, dense_images_follow_their_values_by_default) {
    Volume volume = two_balls();
    EXPECT_EQ(resolved_joint_field("", {&volume, 1}), "");
    MomentOptions moments;
    moments.own_field = "density";
    EXPECT_FALSE(convert_by_default(volume, moments).content.by_value);
    volume.is_image = true;
    EXPECT_EQ(resolved_joint_field("", {&volume, 1}), "volume");
    EXPECT_EQ(resolved_joint_field("none", {&volume, 1}), "");
    EXPECT_EQ(resolved_joint_field("heat", {&volume, 1}), "heat");
    const Gaussians model = convert_by_default(volume, moments);
    EXPECT_TRUE(model.content.by_value);
    EXPECT_EQ(model.fields.names(), std::vector<std::string>{"density"});
    // Small data: Gaussians cost nothing.
    const Made same = made(volume, {});
    EXPECT_EQ(same.model.size(), model.size());
    EXPECT_GT(model.size(), kSmallCount / 4);
    MomentOptions fewer;
    fewer.budget = model.size() / 16, fewer.refine_seconds = 1e-9;  // measured, and no round
    EXPECT_LT(same.joint.value_error, 0.8 * made(volume, fewer).joint.value_error);
    // A stated number of Gaussians is not searched.
    moments.budget = 50;
    const Gaussians few = convert_by_default(volume, moments);
    EXPECT_LE(few.size(), 50u);
    EXPECT_TRUE(few.content.by_value);
}

TEST(convert_for_field, an_error_that_no_count_meets_gives_the_least) {
    const Volume volume = two_balls();
    MomentOptions moments;
    moments.error = 1e-6;
    const Made found = made(volume, moments);
    EXPECT_GT(found.joint.value_error, 1e-6);
    moments.error = 0, moments.budget = 100, moments.refine_seconds = 1e-9;
    EXPECT_LT(found.joint.value_error, 0.7 * made(volume, moments).joint.value_error);
}

/// One light voxel far away changes neither views nor transfer functions.
TEST(convert_for_field, an_error_by_value_is_of_the_mass_not_of_a_voxel_far_away) {
    MomentOptions moments;
    moments.error = 0.3;
    const Made alone = made(two_balls(), moments);
    Volume volume = two_balls();
    Leaf& far = volume.leaves.emplace_back();
    far.origin = {896, 0, 0};
    far.set(0, 1e-3f);
    const Made both = made(volume, moments);
    // The value 1 is no end of the range now, and less certain beside 5.
    EXPECT_LE(alone.joint.value_error, 0.3);
    EXPECT_LE(both.joint.value_error, 0.45);
}

/// A round that would lift the worst view above the error that was asked for is not kept.
TEST(convert_for_field, rounds_keep_the_error_that_was_asked_for) {
    const Volume volume = two_balls();
    MomentOptions moments;
    moments.error = 0.3, moments.refine_seconds = 3;
    const Made found = made(volume, moments);
    EXPECT_LE(found.joint.value_error, 0.3);
    EXPECT_NE(found.model.options.find("--error 0.3"), std::string::npos);
}

TEST(convert_for_field, rounds_lower_the_error_by_value_at_the_same_count) {
    const Volume volume = two_balls();
    MomentOptions moments;
    moments.budget = 150;
    Gaussians model = made(volume, moments).model;
    const std::size_t count = model.size();
    const comparison::ErrorViews depths({&volume, 1}, world_box(volume));
    const auto fields = own_values(volume);
    const comparison::ValueViews views({&volume, 1}, fields[0], depths);
    const double before = views.relative_l2(model).mean;
    int rounds = 0;
    joint::refine_by_value(model, {{&volume, 1}, fields, 0}, views, 0,
                           [&] { return rounds++ < 6; });
    EXPECT_LT(views.relative_l2(model).mean, 0.95 * before);
    EXPECT_LE(model.size(), count);
    EXPECT_GE(model.size(), count - count / 20);
    EXPECT_NEAR(mass(model), mass(volume), 1e-4 * mass(volume));
    EXPECT_EQ(model.fields.names(), std::vector<std::string>{"density"});
    validate(model);
    // No time, no round.
    const Gaussians same = model;
    joint::refine_by_value(model, {{&volume, 1}, fields, 0}, views, 0, [] { return false; });
    EXPECT_EQ(same.mean, model.mean);
}

/// The worst Gaussian is found where its value is spoiled, whatever T.
TEST(value_views, a_spoiled_value_has_the_largest_error) {
    const Volume volume = two_balls();
    MomentOptions moments;
    moments.block_voxels = 4;
    Gaussians model = made(volume, moments).model;
    const comparison::ErrorViews depths({&volume, 1}, world_box(volume));
    const auto fields = own_values(volume);
    const comparison::ValueViews views({&volume, 1}, fields[0], depths);
    const double before = views.relative_l2(model).worst;
    const std::vector<float> errors = views.error_of_each_gaussian(model, views.errors(model));
    // One at the surface of the data, where nothing lies before it.
    std::size_t spoiled = 0;
    for (std::size_t i = 0; i < model.size(); ++i)
        if (world_mean(model, i).x > world_mean(model, spoiled).x) spoiled = i;
    model.fields.scalar[0].value[spoiled] = 5;
    EXPECT_GT(views.relative_l2(model).worst, before);
    const std::vector<float> after = views.error_of_each_gaussian(model, views.errors(model));
    std::size_t most = 0;
    for (std::size_t i = 0; i < model.size(); ++i)
        if (after[i] - errors[i] > after[most] - errors[most]) most = i;
    EXPECT_LT(length(world_mean(model, most) - world_mean(model, spoiled)), 4.0);
    EXPECT_GT(after[spoiled], 1.2f * errors[spoiled]);
}

TEST(convert_for_field, refuses_what_has_no_picture_by_value) {
    const Volume volume = two_balls();
    MomentOptions moments;
    moments.budget = 50, moments.refine_seconds = 1;
    FieldOptions options;
    options.joint_field = "velocity";
    VoxelField velocity;
    velocity.name = "velocity", velocity.upper = 1;
    for (int c = 0; c < 3; ++c) {
        VoxelValues values;
        for (std::size_t l = 0; l < volume.leaves.size(); ++l)
            values.leaf.emplace_back().fill(static_cast<float>(l) / 64);
        velocity.component.push_back(values);
    }
    const std::vector<std::vector<VoxelField>> vectors{{velocity}};
    EXPECT_EQ(
        test::refusal([&] { (void)convert_for_field(volume, vectors, moments, options); }),
        "field velocity: a vector, expected a scalar one for an error or refinement by value");
    // Without an error to judge, a vector is fitted as before.
    moments.refine_seconds = 0;
    EXPECT_EQ(convert_for_field(volume, vectors, moments, options).fields.vector.size(), 1u);
    moments.refine_seconds = 1;
    VoxelField constant = velocity;
    constant.name = "one", constant.lower = constant.upper = 1;
    constant.component.resize(1);
    for (auto& leaf : constant.component[0].leaf) leaf.fill(1);
    const std::vector<std::vector<VoxelField>> constants{{constant}};
    options.joint_field = "one";
    EXPECT_EQ(test::refusal([&] { (void)convert_for_field(volume, constants, moments, options); }),
              "balls.vdb: field one: all values are 1, expected several for pictures by value");
    options.joint_field = "heat";
    EXPECT_EQ(test::refusal([&] { (void)convert_for_field(volume, constants, moments, options); }),
              "no field 'heat' to fit the Gaussians to (there are: one)");
}

}  // namespace
}  // namespace vog
