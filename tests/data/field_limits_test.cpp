// field_limits_test.cpp: planes of fields stay within the range of the data, and keep their moments.
#include "data/fields/field_limits.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/data.h"
#include "vog/ply.h"

namespace vog {
namespace {

/// One Gaussian, turned, of a field from 0 to 10.
Gaussians one(float value, Vec3f gradient) {
    Gaussians model;
    model.mean = {{1, 2, 3}};
    model.scale = {{0.5f, 1, 2}};
    model.rotation = {{0.9238795f, 0, 0.3826834f, 0}};
    model.density = {1};
    ScalarField field;
    field.name = "heat", field.lower = 0, field.upper = 10;
    field.value = {value}, field.gradient = {gradient};
    field.deviation = {0.5f}, field.skewness = {2};
    model.fields.scalar.push_back(field);
    return model;
}

TEST(field_limits, planes_reach_the_nearer_end_of_the_range_and_keep_two_moments) {
    Gaussians model = one(7, {2, -1, 1.5f});
    const ScalarField before = model.fields.scalar.front();
    const double spread2 = plane_variance(model, before, 0);
    limit_planes(model);
    const ScalarField& after = model.fields.scalar.front();
    const double reach{model.cutoff}, left2 = plane_variance(model, after, 0);
    ASSERT_GT(reach * std::sqrt(spread2), 3);
    EXPECT_NEAR(reach * std::sqrt(left2), 3, 1e-5);
    EXPECT_EQ(after.value[0], 7);
    const double within = variance_within(reach);
    const auto second = [&](const ScalarField& f, double plane2) {
        return within * plane2 + double{f.deviation[0]} * double{f.deviation[0]};
    };
    EXPECT_NEAR(second(after, left2), second(before, spread2), 1e-5 * second(before, spread2));
    const auto third = [](const ScalarField& f) {
        return double{f.skewness[0]} * std::pow(double{f.deviation[0]}, 3);
    };
    EXPECT_NEAR(third(after), third(before), 1e-5);
    // The direction stays.
    EXPECT_NEAR(double{after.gradient[0].y} / double{after.gradient[0].x}, -0.5, 1e-6);
    EXPECT_NEAR(double{after.gradient[0].z} / double{after.gradient[0].x}, 0.75, 1e-6);
    // Once.
    const ScalarField limited = after;
    limit_planes(model);
    EXPECT_EQ(model.fields.scalar.front().gradient, limited.gradient);
    EXPECT_EQ(model.fields.scalar.front().deviation, limited.deviation);
}

TEST(field_limits, planes_within_the_range_stay) {
    Gaussians model = one(5, {0.3f, 0.2f, -0.4f});
    const ScalarField before = model.fields.scalar.front();
    limit_planes(model);
    EXPECT_EQ(model.fields.scalar.front().gradient, before.gradient);
    EXPECT_EQ(model.fields.scalar.front().deviation, before.deviation);
    EXPECT_EQ(model.fields.scalar.front().skewness, before.skewness);
}

TEST(field_limits, values_at_an_end_have_no_slope) {
    Gaussians model = one(10, {1, 0, 0});
    limit_planes(model);
    EXPECT_EQ(plane_variance(model, model.fields.scalar.front(), 0), 0);
    EXPECT_GT(model.fields.scalar.front().deviation[0], 0.5f);
}

TEST(field_limits, older_models_are_limited_when_read) {
    const test::TempDir folder;
    const Gaussians model = one(7, {2, -1, 1.5f});
    write_ply(folder / "old.ply", model);
    Gaussians limited = model;
    limit_planes(limited);
    const Gaussians read = read_ply(folder / "old.ply");
    EXPECT_EQ(read.fields.scalar.front().gradient, limited.fields.scalar.front().gradient);
    EXPECT_EQ(read.fields.scalar.front().deviation, limited.fields.scalar.front().deviation);
}

}  // namespace
}  // namespace vog
