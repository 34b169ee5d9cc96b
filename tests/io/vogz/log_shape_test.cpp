// log_shape_test.cpp: shapes and their logarithms invert each other on every SIMD target.
#include "io/vogz/log_shape.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

namespace vog::test {

using namespace vogz;

namespace {

/// Calls a function with each SIMD target of this machine chosen.
template <class Use>
void on_every_target(const Use& use) {
    std::int64_t targets = hwy::SupportedTargets();
    for (; targets != 0; targets &= targets - 1) {
        const std::int64_t target = targets & -targets;
        SCOPED_TRACE(hwy::TargetName(target));
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(target);
        use();
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

/// Gaussians of any direction: round, flat, long, nearly so, and along the axes.
Gaussians shapes() {
    Gaussians model;
    std::mt19937 random(7);
    std::normal_distribution<float> component;
    const auto add = [&](Vec3f scale, Quat rotation) {
        model.mean.push_back({});
        model.density.push_back(1);
        model.scale.push_back(scale);
        model.rotation.push_back(rotation);
    };
    for (int n = 0; n < 500; ++n)
        for (const Vec3f scale : {Vec3f{1, 1, 1},
                                  {2, 2, 0.5f},
                                  {2, 0.5f, 0.5f},
                                  {1, 1.0001f, 1},
                                  {0.3f, 1, 3},
                                  {1e-4f, 1, 20},
                                  {1e-6f, 1e-5f, 2e-6f}})
            add(scale,
                {component(random), component(random), component(random), component(random)});
    const float half = std::sqrt(0.5f);
    for (const Quat turn : {Quat{1, 0, 0, 0},
                            {0, 1, 0, 0},
                            {half, half, 0, 0},
                            {half, 0, half, 0},
                            {half, 0, 0, half},
                            {0.5f, 0.5f, 0.5f, 0.5f}})
        add({0.5f, 1, 2}, turn), add({1, 1, 2}, turn);
    return model;
}

std::array<std::vector<double>, 3> log_scales(const Gaussians& model) {
    std::array<std::vector<double>, 3> logs;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const Vec3f s : model.scale) logs[axis].push_back(double{s[static_cast<int>(axis)]});
        take_logarithms(logs[axis]);
    }
    return logs;
}

}  // namespace

TEST(vogz_shapes, logarithms_come_back) {
    const Gaussians model = shapes();
    std::vector<std::uint32_t> index(model.size());
    std::iota(index.begin(), index.end(), 0u);
    on_every_target([&] {
        const LogShapes logs = log_shapes(model, index, log_scales(model));
        Gaussians back = model;
        back.scale.assign(model.size(), {});
        back.rotation.assign(model.size(), {});
        std::vector<double> spread(model.size());
        set_shapes(back, 0, logs.entry, spread);
        const LogShapes again = log_shapes(back, index, log_scales(back));
        for (std::size_t i = 0; i < model.size(); ++i) {
            const Vec3d s = vec_cast<double>(model.scale[i]);
            ASSERT_NEAR(spread[i] / std::cbrt(s.x * s.y * s.z), 1, 1e-12) << i;
            // Floats of a dozen rotations turn the axes by about 1e-6, which displaces entries by it times the logarithm of
            // the axes' ratio.
            const double longer = std::max({s.x, s.y, s.z}) / std::min({s.x, s.y, s.z});
            const double bound = 1e-6 + 4e-6 * std::log(longer);
            for (std::size_t k = 0; k < logs.entry.size(); ++k)
                ASSERT_NEAR(again.entry[k][i], logs.entry[k][i], bound) << i << " " << k;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const Box box = support_box(model, i);
                const int a = static_cast<int>(axis);
                ASSERT_NEAR(2 * model.cutoff * logs.extent[axis][i] / (box.upper[a] - box.lower[a]),
                            1, 1e-9)
                    << i;
            }
        }
    });
}

TEST(vogz_shapes, exponentials_and_logarithms_are_those_of_the_library) {
    on_every_target([] {
        // Lengths beside whole vectors, and both ends.
        for (const std::size_t count : {std::size_t{1}, std::size_t{7}, std::size_t{1001}}) {
            std::vector<double> numbers(count), powers;
            for (std::size_t n = 0; n < count; ++n)
                numbers[n] = 699.0 * std::sin(static_cast<double>(n) + 1);
            powers = numbers;
            take_exponentials(powers);
            for (std::size_t n = 0; n < count; ++n)
                ASSERT_NEAR(powers[n] / std::exp(numbers[n]), 1, 1e-14) << numbers[n];
            take_logarithms(powers);
            for (std::size_t n = 0; n < count; ++n)
                ASSERT_NEAR(powers[n], numbers[n], 1e-12) << numbers[n];
        }
        std::vector<double> beyond{-1e300, 1e300};
        take_exponentials(beyond);
        EXPECT_DOUBLE_EQ(beyond[0], std::exp(-700.0));
        EXPECT_DOUBLE_EQ(beyond[1], std::exp(700.0));
    });
}

}  // namespace vog::test
