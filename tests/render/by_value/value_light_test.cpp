// value_light_test.cpp: expected light over distributions of values.
#include "render/by_value/value_light.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vog {

using namespace by_value;

namespace {

/// Extinction rising with the value, 0 to 1 over 0 to 10, opacity per 1 unit; white.
ValueTransfer ramp() {
    ValueTransfer transfer{"ramp", {{0, 1, 1, 1}}, {}, 1};
    for (int n = 0; n <= 1000; ++n)
        transfer.opacity.push_back({0.01 * n, 1 - std::exp(-0.001 * n)});
    return transfer;
}

TEST(value_light, expectation_of_a_linear_extinction_is_that_of_the_mean) {
    const ExpectedLight expected(ramp(), 0, 10, false);
    for (const double mean : {3.0, 5.0, 6.5})
        for (const double deviation : {0.0, 0.01, 0.3, 1.0})
            for (const double skewness : {0.0, 1.5}) {
                const Light light = expected.pair(deviation, skewness).at(mean);
                // Columns of a 512th of the range, and three deviations of the normal distribution.
                EXPECT_NEAR(light[3], 0.1 * mean, 3e-3) << mean << ' ' << deviation;
                EXPECT_FLOAT_EQ(light[0], light[3]);
            }
}

TEST(value_light, light_per_value_of_a_linear_extinction_is_constant) {
    const ExpectedLight expected(ramp(), 0, 10, true);
    for (const double mean : {0.5, 3.0, 9.0})
        EXPECT_NEAR(expected.pair(0.4, 0.5).at(mean)[3], 0.1, 1e-3);
}

TEST(value_light, a_step_is_the_share_of_the_values_above_it) {
    ValueTransfer step{"step", {{0, 1, 0, 0}}, {{5, 0}, {5, 1 - std::exp(-1.0)}}, 1};
    const ExpectedLight expected(step, 0, 10, false);
    const auto share = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
    for (const double mean : {4.0, 5.0, 5.5}) {
        // Without skewness the pair is nearly two values at one deviation on either side.
        const double c = 0.95, narrow = std::sqrt(1 - c * c);
        const double above =
            0.5 * share((mean + c - 5) / narrow) + 0.5 * share((mean - c - 5) / narrow);
        EXPECT_NEAR(expected.pair(1, 0).at(mean)[3], above, 0.02) << mean;
    }
    // Skewness 3: most values a little below the mean, few far above.
    EXPECT_NEAR(expected.pair(1, 3).at(4)[3], 0.07, 0.03);
    EXPECT_NEAR(expected.pair(1, -3).at(4)[3], 0, 0.01);
}

TEST(value_light, narrow_bands_of_a_wide_range_are_met) {
    // A band of a thousandth of the data's range, from outliers: its mean is exact by the integrals.
    ValueTransfer band{"band", {{0, 1, 0, 0}}, {{1, 0}, {1.5, 0.5}, {2, 0}}, 1};
    const ExpectedLight expected(band, 0, 1000, false);
    EXPECT_NEAR(expected.pair(0, 0).at(1.5)[3], std::log(2), 0.03);
    EXPECT_NEAR(expected.pair(0, 0).at(1.25)[3], -std::log(0.75), 0.02);
    EXPECT_EQ(expected.pair(0, 0).at(100)[3], 0);
}

TEST(value_light, quadratics_follow_the_expectation_over_a_gaussian) {
    Gaussians model;
    model.mean = {{0, 0, 0}};
    model.scale = {{0.5f, 1, 1}};
    model.density = {1};
    ScalarField field{"heat", "", 0, 10, false, {}, {5}, {{2, 0, 0}}, {0.5f}, {0}};
    model.fields.scalar.push_back(field);
    const std::vector<LightQuadratic> light = fit_light(model, field, ramp());
    EXPECT_FLOAT_EQ(light[0].spread, 1);
    for (const float z : {-2.0f, -1.0f, 0.0f, 1.5f})
        EXPECT_NEAR(light[0].at(z)[3], 0.1 * (5 + double{z}), 5e-3);
}

}  // namespace
}  // namespace vog
