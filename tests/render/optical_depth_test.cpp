// optical_depth_test.cpp: The closed form against quadrature of the density, and the kernel polynomial
// against the closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/kernel_polynomial.h"
#include "render/splat/splat.h"
#include "support/scenes.h"

namespace vog::test {

namespace {

/// Density of Gaussian i at a point, by its definition.
double density(const Gaussians& model, std::size_t i, Vec3d point) {
    const Vec3d w = whitening(model, i) * (point - vec_cast<double>(model.mean[i]));
    const double m2 = dot(w, w);
    return m2 <= double{model.cutoff} * model.cutoff ? model.density[i] * std::exp(-0.5 * m2) : 0;
}

/// ∫ density along origin + t direction over the part of the support with t >= 0, by composite
/// Simpson on the segment found by bisection of the support's indicator along the ray.
double quadrature(const Gaussians& model, std::size_t i, Vec3d origin, Vec3d direction) {
    const Vec3d d = normalized(direction);
    const Vec3d to_mean = vec_cast<double>(model.mean[i]) - origin;
    const auto distance2 = [&](double t) {
        const Vec3d w = whitening(model, i) * (t * d - to_mean);
        return dot(w, w);
    };
    // The whitened distance is convex along the ray: ternary search for its minimum.
    const Vec3f s = model.scale[i];
    const double reach = length(to_mean) + model.cutoff * std::max({s.x, s.y, s.z});
    double low = -reach, high = reach;
    for (int n = 0; n < 200; ++n) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        (distance2(a) < distance2(b) ? high : low) = distance2(a) < distance2(b) ? b : a;
    }
    const double nearest = 0.5 * (low + high), k2 = double{model.cutoff} * model.cutoff;
    if (distance2(nearest) >= k2) return 0;
    const auto edge = [&](double inside, double outside) {
        for (int n = 0; n < 100; ++n) {
            const double middle = 0.5 * (inside + outside);
            (distance2(middle) < k2 ? inside : outside) = middle;
        }
        return 0.5 * (inside + outside);
    };
    const double t1 = edge(nearest, 2 * reach), t0 = std::max(edge(nearest, -2 * reach), 0.0);
    if (t1 <= t0) return 0;
    constexpr int kSteps = 400;
    double sum = 0;
    for (int n = 0; n <= kSteps; ++n) {
        // Just inside the support, so that rounding at its edge does not matter.
        const double t = t0 + (t1 - t0) * (1e-9 + (1 - 2e-9) * n / kSteps);
        sum += (n == 0 || n == kSteps ? 1 : n % 2 ? 4 : 2) * density(model, i, origin + t * d);
    }
    return sum * (t1 - t0) / (3 * kSteps);
}

}  // namespace

TEST(optical_depth, ten_thousand_random_rays_match_quadrature) {
    const Gaussians model = random_gaussians(10000, 0.02, 0.8, 31);
    Random random(32);
    double largest = 0, worst = 0;
    int hits = 0;
    for (std::size_t i = 0; i < model.size(); ++i) {
        // Half the eyes lie among the Gaussians, so that segments are clipped at the eye too.
        const Vec3d origin = random.in_cube(i % 2 ? 1.0 : 4.0);
        const Vec3d target = vec_cast<double>(model.mean[i]) + random.in_cube(0.5);
        const double tau = optical_depth(model, i, origin, target - origin);
        const double expected = quadrature(model, i, origin, target - origin);
        hits += expected > 0;
        largest = std::max(largest, expected);
        worst = std::max(worst, std::abs(tau - expected));
    }
    EXPECT_GT(hits, 5000);
    // Simpson on 400 steps of a Gaussian is exact to 1e-9; the closed form is limited by erf.
    EXPECT_LE(worst, 1e-7 * largest);
}

TEST(optical_depth, along_and_across_the_axes_of_one_gaussian) {
    Gaussians model;
    add(model, {1, 2, 3}, {0.5f, 1, 2}, 4);
    const double root = std::sqrt(2 * std::acos(-1.0)), inside = std::erf(2.25 / std::sqrt(2.0));
    for (int axis = 0; axis < 3; ++axis) {
        Vec3d origin{1, 2, 3}, direction;
        origin[axis] -= 50;
        direction[axis] = 7;  // any length
        EXPECT_NEAR(optical_depth(model, 0, origin, direction),
                    4 * model.scale[0][axis] * root * inside, 1e-12);
    }
    // One standard deviation off the axis: e^{-1/2}, and a shorter chord.
    const double chord = std::erf(std::sqrt(0.5 * (2.25 * 2.25 - 1)));
    EXPECT_NEAR(optical_depth(model, 0, {1.5, 2, -50}, {0, 0, 1}),
                4 * 2 * root * std::exp(-0.5) * chord, 1e-12);
    EXPECT_EQ(optical_depth(model, 0, {1.5 * 2, 2, -50}, {0, 0, 1}), 0) << "beyond the cutoff";
    EXPECT_EQ(optical_depth(model, 0, {1, 2, 50}, {0, 0, 1}), 0) << "behind the eye";
}

TEST(kernel_polynomial, stays_within_its_stated_error) {
    for (const double cutoff : {0.1, 0.5, 1.0, 2.25, 3.0349, 4.2, 6.0, 8.0}) {
        const KernelPolynomial kernel = fit_kernel(cutoff);
        EXPECT_LE(kernel.max_error, 2e-6) << "cutoff " << cutoff;
        const double top = 0.5 * cutoff * cutoff;
        const double peak = std::sqrt(2 * std::acos(-1.0)) * std::erf(std::sqrt(top));
        for (int n = 1; n <= 1000; ++n) {
            const double u = top * n / 1000;
            const float v = static_cast<float>(2 * u) * kernel.slope + kernel.shift;
            float sum = 0;
            for (auto c = kernel.coefficient.rbegin(); c != kernel.coefficient.rend(); ++c)
                sum = sum * v + *c;
            const double exact =
                std::sqrt(2 * std::acos(-1.0)) * std::exp(u - top) * std::erf(std::sqrt(u));
            // The fit's error plus float evaluation of it.
            ASSERT_NEAR(std::sqrt(2 * u) * sum, exact, 3.5e-6 * peak)
                << "cutoff " << cutoff << " u " << u;
        }
    }
}

TEST(kernel_polynomial, default_cutoff_needs_degree_six) {
    EXPECT_EQ(fit_kernel(2.25).coefficient.size(), 7u);
}

TEST(kernel_polynomial, positive_without_a_clamp_in_powers_of_u) {
    for (const double cutoff : {0.5, 1.0, 2.25, 3.0349}) {
        const KernelPolynomial kernel = fit_kernel(cutoff);
        ASSERT_EQ(kernel.shift, 0);
        for (int n = 0; n <= 1000; ++n) {
            const auto v = static_cast<float>(cutoff * cutoff * n / 1000);
            float sum = 0;
            for (auto c = kernel.coefficient.rbegin(); c != kernel.coefficient.rend(); ++c)
                sum = sum * v + *c;
            ASSERT_GT(sum, 0) << "cutoff " << cutoff << " v " << v;
        }
    }
}

}  // namespace vog::test
