// light_of_moments_test.cpp: mean light of normally distributed values, against fine quadrature.
#include "render/by_value/light_of_moments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/device/value_moments.h"

namespace vog {

using namespace by_value;

namespace {

/// Mean light of a normal distribution cut to the range, by 20,000 steps.
std::array<double, 4> quadrature(const ValueTransfer& transfer, const ValueRange& range,
                                 bool per_value, double mean, double deviation) {
    constexpr int kSteps = 20000;
    std::array<double, 4> sum{};
    double whole = 0;
    for (int n = 0; n < kSteps; ++n) {
        const double z = 12.0 * (n + 0.5) / kSteps - 6, share = mean + z * deviation;
        if (share < 0 || share > 1) continue;
        const double value = range.value(share), weight = std::exp(-0.5 * z * z);
        const ValueLight light = light_of(transfer, value);
        const double measure =
            std::max(value - range.background, 1e-3 * (range.upper - range.background));
        const double s = light.extinction / (per_value ? measure : 1);
        const double part[4] = {s * light.r, s * light.g, s * light.b, s};
        for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * part[c];
        whole += weight;
    }
    for (double& c : sum) c /= whole;
    return sum;
}

std::array<float, 4> closed_form(const LightOfMoments& light, float mean, float deviation) {
    std::array<float, 4> out;
    light.mean_light().pieces.light(mean, deviation, out.data());
    return out;
}
std::array<float, 4> table_at(const LightOfMoments& light, float mean, float variance) {
    std::array<float, 4> out;
    light.mean_light().at(mean, variance, out.data());
    return out;
}

/// Opacity in a band of a width, and a ramp beside it, of two colours.
ValueTransfer band(double from, double width) {
    return {
        "band",
        {{0, 0.2f, 1, 0}, {from, 0.2f, 1, 0}, {from, 1, 0.5f, 0.25f}, {10, 1, 0.5f, 0.25f}},
        {{0, 0}, {from, 0.02}, {from, 0.7}, {from + width, 0.7}, {from + width, 0.02}, {10, 0.5}},
        2};
}

TEST(light_of_moments, is_the_integral_over_a_normal_distribution) {
    for (const auto& [per_value, background] : {std::pair{false, 0.0}, {true, 0.0}, {true, -3.0}})
        for (const double width : {3.0, 0.4, 0.01}) {
            const ValueRange range{0, 10, background};
            const ValueTransfer transfer = band(4, width);
            const LightOfMoments light(transfer, range, per_value);
            double most = 0;
            for (double m = 0; m <= 1; m += 0.01)
                most = std::max(most, double{closed_form(light, static_cast<float>(m), 0)[3]});
            for (const double mean : {0.05, 0.3, 0.39, 0.4005, 0.45, 0.7, 1.0})
                for (const double deviation : {0.002, 0.01, 0.05, 0.3}) {
                    const auto expected = quadrature(transfer, range, per_value, mean, deviation);
                    const auto found =
                        closed_form(light, static_cast<float>(mean), static_cast<float>(deviation));
                    // Reach of 4 deviations, and pieces linear to a 500th.
                    for (std::size_t c = 0; c < 4; ++c)
                        EXPECT_NEAR(found[c], expected[c], 2e-3 * most + 3e-3 * expected[3])
                            << mean << ' ' << deviation << ' ' << width << ' ' << c;
                }
        }
}

TEST(light_of_moments, the_table_follows_the_closed_form) {
    const LightOfMoments light(band(4, 0.4), {0, 10}, true);
    EXPECT_TRUE(light.resolved());
    float most = 0;
    for (float m = 0; m <= 1; m += 0.001f) most = std::max(most, closed_form(light, m, 0)[3]);
    for (const float mean : {0.0f, 0.1f, 0.3987f, 0.41f, 0.4391f, 0.63f, 1.0f})
        for (const float deviation : {0.003f, 0.0041f, 0.02f, 0.1f, 0.5f}) {
            const auto expected = closed_form(light, mean, deviation);
            const auto found = table_at(light, mean, deviation * deviation);
            for (std::size_t c = 0; c < 4; ++c)
                EXPECT_NEAR(found[c], expected[c], 0.015f * most) << mean << ' ' << deviation;
        }
}

TEST(light_of_moments, no_label_lies_between_two_that_meet) {
    // Half of label 0 and half of 1 reach to 2 as normal distributions, a little: dense volumes show that.
    const ValueTransfer second{
        "second", {{0, 1, 0, 0}, {5, 1, 0, 0}}, {{1.5, 0}, {1.5, 0.9}, {2.5, 0.9}, {2.5, 0}}, 1};
    ScalarField field;
    field.lower = 0, field.upper = 5;
    field.value = {0, 1, 2, 5}, field.gradient.resize(4), field.deviation.resize(4);
    ASSERT_TRUE(value_range(field).labels);
    const LightOfMoments labels(second, value_range(field), false);
    field.value[1] = 1.5f;
    ASSERT_FALSE(value_range(field).labels);
    const LightOfMoments values(second, value_range(field), false);
    const auto extinction = [&](const LightOfMoments& light, float step) {
        float out[4];
        device::mean_light_of(light.mean_light(),
                              {1, 0.5f * step, 0.25f * step * step, 0, {0, 0, 0}}, 1, out);
        return out[3];
    };
    EXPECT_GT(extinction(values, 1.0f / 5), 1e-5f);
    EXPECT_EQ(extinction(labels, 1.0f / 3), 0);
}

TEST(light_of_moments, labels_with_large_numbers_are_the_two_of_a_part) {
    ScalarField field;
    field.value = {0, 17, 53, 1035, 2035, 0};
    field.lower = 0, field.upper = 2035;
    field.gradient.resize(6), field.deviation.resize(6);
    const ValueRange range = value_range(field);
    ASSERT_EQ(range.order, (std::vector<float>{0, 17, 53, 1035, 2035}));
    for (std::size_t n = 0; n < range.order.size(); ++n) {
        EXPECT_EQ(range.share(double{range.order[n]}), static_cast<double>(n) / 4);
        EXPECT_EQ(range.value(static_cast<double>(n) / 4 + 0.1), double{range.order[n]});
    }
    EXPECT_EQ(range.share(30), 1.5 / 4);
    // Each label but 0 has a colour of its own: red, green, blue, white.
    ValueTransfer transfer{"organs", {}, {}, 1};
    const float colors[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    for (std::size_t n = 0; n < 4; ++n)
        for (const double end : {-0.5, 0.5}) {
            const double value = double{range.order[n + 1]} + end;
            transfer.color.push_back({value, colors[n][0], colors[n][1], colors[n][2]});
            if (end < 0) transfer.opacity.push_back({value, 0});
            transfer.opacity.push_back({value, 0.5});
            if (end > 0) transfer.opacity.push_back({value, 0});
        }
    const LightOfMoments light(transfer, range, false);
    const double extinction = std::log(2);
    for (const std::size_t first : {0u, 1u, 3u})
        for (std::size_t second = first + 1; second < 5; ++second)
            for (const double weight : {0.01, 0.1, 0.5, 0.95}) {
                // Moments of two labels, as single precision has them.
                const double a = static_cast<double>(first) / 4;
                const double step = static_cast<double>(second) / 4 - a;
                const double spread = weight * (1 - weight) * step * step;
                const device::ValueMoments m{1,
                                             static_cast<float>(a + weight * step),
                                             static_cast<float>(spread),
                                             static_cast<float>(spread * (1 - 2 * weight) * step),
                                             {0, 0, 0}};
                float out[4];
                device::mean_light_of(light.mean_light(), m, 1, out);
                for (std::size_t c = 0; c < 3; ++c) {
                    const auto of = [&](std::size_t n) {
                        return n == 0 ? 0.0 : extinction * double{colors[n - 1][c]};
                    };
                    EXPECT_NEAR(double{out[c]}, (1 - weight) * of(first) + weight * of(second),
                                1e-3)
                        << first << ' ' << second << ' ' << weight << ' ' << c;
                }
            }
}

TEST(light_of_moments, any_band_is_met_beside_any_range) {
    // Labels 1 and 2 of two thousand, and a band around one far away.
    const ValueTransfer labels{"labels",
                               {{0.5, 1, 0, 0}, {1.5, 1, 0, 0}, {1.5, 0, 1, 0}, {1e6, 0, 1, 0}},
                               {{0.5, 0},
                                {0.5, 0.5},
                                {2.5, 0.5},
                                {2.5, 0},
                                {2000, 0},
                                {2000, 0.9},
                                {2000.5, 0.9},
                                {2000.5, 0}},
                               1};
    const ValueRange range{0, 1e5};
    const LightOfMoments light(labels, range, false);
    EXPECT_FALSE(light.resolved());
    const auto at = [&](double value, double deviation) {
        return closed_form(light, static_cast<float>(range.share(value)),
                           static_cast<float>(deviation / 1e5));
    };
    EXPECT_NEAR(at(1, 0)[0], std::log(2), 1e-3);
    EXPECT_EQ(at(1, 0)[1], 0);
    EXPECT_NEAR(at(2, 0.05)[1], std::log(2), 1e-3);
    EXPECT_NEAR(at(2000.25, 0)[3], std::log(10), 1e-2);
    EXPECT_EQ(at(1000, 3)[3], 0);
    // Half a unit of two thousand deviations.
    EXPECT_NEAR(at(2000, 50)[3], std::log(10) * 0.5 / (50 * std::sqrt(2 * std::acos(-1.0))), 1e-3);
}

TEST(light_of_moments, colours_lie_between_those_of_the_transfer_function) {
    const LightOfMoments light(band(4, 0.1), {0, 10}, true);
    for (float mean = 0; mean <= 1; mean += 0.013f)
        for (const float variance : {0.0f, 1e-7f, 1e-5f, 1e-3f, 0.1f})
            for (const auto& s :
                 {closed_form(light, mean, std::sqrt(variance)), table_at(light, mean, variance)}) {
                ASSERT_GE(s[3], 0);
                for (const auto& [c, low, high] :
                     {std::tuple{0u, 0.2f, 1.0f}, {1u, 0.5f, 1.0f}, {2u, 0.0f, 0.25f}}) {
                    ASSERT_GE(s[c], low * s[3] * 0.9999f - 1e-12f);
                    ASSERT_LE(s[c], high * s[3] * 1.0001f + 1e-12f);
                }
            }
}

}  // namespace
}  // namespace vog
