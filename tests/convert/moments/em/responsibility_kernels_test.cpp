// responsibility_kernels_test.cpp: SIMD loops of the E step against sums in double precision.
#include "convert/moments/em/responsibility_kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace vog {

using namespace moments;
namespace {

struct alignas(64) Aligned {
    BrickFloats sum{};
    std::array<float, 64 * kRun> values{};
};

/// A Gaussian with full covariance near the middle of a brick, over some of its runs.
RunKernel slanted() {
    RunKernel k;
    k.dx = -3.2f, k.dy = -4.1f, k.dz = -2.7f, k.step = 1;
    k.xx = 0.011f, k.yy = 0.02f, k.zz = 0.03f, k.xy = 0.004f, k.xz = -0.007f, k.yz = 0.009f;
    k.peak = 0.8f;
    k.x0 = 1, k.x1 = 6, k.y0 = 0, k.y1 = 3;
    return k;
}

/// Point n relative to the mean.
Vec3d offset(const RunKernel& k, int n) {
    return {double{k.dx} + (n >> 6), double{k.dy} + (n >> 3 & 7), double{k.dz} + (n & 7)};
}

TEST(responsibility_kernels, values_are_those_of_a_truncated_gaussian) {
    const RunKernel k = slanted();
    Aligned data;
    data.sum.fill(0.25f);
    add_values(std::span(&k, 1), data.values.data(), data.sum);
    int inside = 0;
    for (int n = 0; n < kLeafVoxels; ++n) {
        const Vec3d d = offset(k, n);
        const double u = double{k.xx} * d.x * d.x + double{k.yy} * d.y * d.y +
                         double{k.zz} * d.z * d.z + double{k.xy} * d.x * d.y +
                         double{k.xz} * d.x * d.z + double{k.yz} * d.y * d.z;
        const bool inside_support =
            32 * u < kSupportDeviations * kSupportDeviations && n >> 6 >= 1 && n >> 6 <= 6;
        const double exact = inside_support ? double{k.peak} * std::exp(-16 * u) : 0;
        // The second-order polynomial of exp(-u) is too large by u^3/6, sixteen times.
        EXPECT_NEAR(data.sum[static_cast<std::size_t>(n)], 0.25 + exact,
                    exact * 16 * std::exp(u) * u * u * u / 6 + 1e-6);
        inside += inside_support;
    }
    EXPECT_GT(inside, 100);
}

TEST(responsibility_kernels, parts_have_the_moments_of_weighted_values) {
    const RunKernel k = slanted();
    Aligned data;
    add_values(std::span(&k, 1), data.values.data(), data.sum);
    const BrickFloats values = data.sum;
    alignas(64) BrickFloats weight;
    for (int n = 0; n < kLeafVoxels; ++n)
        weight[static_cast<std::size_t>(n)] = 0.5f + 0.3f * static_cast<float>(n % 7);
    MomentSums part;
    add_responsibilities(std::span(&k, 1), data.values.data(), weight, {&part, 1});
    MomentSums exact;
    for (int n = 0; n < kLeafVoxels; ++n) {
        const auto at = static_cast<std::size_t>(n);
        const double m = double{values[at]} * double{weight[at]};
        const Vec3d x = offset(k, n);
        exact.mass += m;
        exact.first = exact.first + m * x;
        std::size_t entry = 0;
        for (int a = 0; a < 3; ++a)
            for (int b = a; b < 3; ++b) exact.second[entry++] += m * x[a] * x[b];
    }
    const double tolerance = 1e-5 * exact.mass;
    EXPECT_NEAR(part.mass, exact.mass, tolerance);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(part.first[axis], exact.first[axis], 4 * tolerance);
    for (std::size_t n = 0; n < 6; ++n)
        EXPECT_NEAR(part.second[n], exact.second[n], 16 * tolerance);
}

TEST(responsibility_kernels, weights_are_mass_over_sum_and_uncovered_points_are_reported) {
    Aligned data;
    data.sum.fill(2);
    std::array<float, kLeafVoxels> value;
    value.fill(3);
    value[5] = 0;
    data.sum[5] = 0;  // neither mass nor a Gaussian: nothing is lost
    BrickFloats sum = data.sum;
    EXPECT_FALSE(responsibility_weights(value.data(), 0.25f, data.sum));
    EXPECT_EQ(data.sum[0], 0.375f);
    EXPECT_EQ(data.sum[5], 0);
    value[5] = 1e-3f;
    alignas(64) BrickFloats again = sum;
    EXPECT_TRUE(responsibility_weights(value.data(), 0.25f, again));
    EXPECT_EQ(again[5], 0);
}

/// Far from the mean of a needle rounding makes its quadratic form negative: infinite values would lose mass.
TEST(responsibility_kernels, values_exceed_no_peak_where_the_form_is_lost_to_rounding) {
    RunKernel kernel;
    kernel.dx = 1e6f, kernel.xx = -1e-6f, kernel.peak = 0.5f;
    kernel.x0 = 0, kernel.x1 = 7, kernel.y0 = 0, kernel.y1 = 3;
    alignas(64) float values[kLeafVoxels];
    alignas(64) BrickFloats sum{};
    add_values(std::span(&kernel, 1), values, sum);
    for (const float value : sum) EXPECT_LE(value, kernel.peak);
}

}  // namespace
}  // namespace vog
