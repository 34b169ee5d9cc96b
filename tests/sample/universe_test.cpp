// universe_test.cpp: synthetic particles: reproducible, clustered, with the documented speed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "vog/convert_points.h"
#include "vog/error.h"
#include "vog/progress.h"
#include "vog/sample.h"

namespace vog {
namespace {

Points sample(int size, std::uint32_t seed = 1) {
    ParticleSampleOptions options;
    options.size = size;
    options.seed = seed;
    return sample_particles(options);
}

TEST(sample_particles, fill_a_box_and_move) {
    const Points points = sample(40);
    validate(points);
    ASSERT_EQ(points.size(), 64000u);
    for (const Vec3d& p : points.position)
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GE(p[axis], 0);
            EXPECT_LE(p[axis], 100);
        }
    double speed2 = 0;
    for (const Vec3f& v : points.velocity) speed2 += double{dot(v, v)};
    EXPECT_NEAR(std::sqrt(speed2 / 64000), 300, 0.01);
}

TEST(sample_particles, are_clustered_over_two_decades_of_density) {
    const Points points = sample(40);
    PointOptions options;
    const Gaussians model = convert_points(points, options);
    std::vector<float> widths;
    for (const Vec3f& scale : model.scale) widths.push_back(scale.x);
    std::sort(widths.begin(), widths.end());
    // Percentiles 1 and 99 of the widths: a factor of 5 in width is two decades of density.
    // Measured 7.0.
    EXPECT_GT(widths[widths.size() * 99 / 100] / widths[widths.size() / 100], 5);
}

TEST(sample_particles, same_bytes_for_any_number_of_threads_and_another_with_another_seed) {
    const Points points = sample(24);
    {
        const ThreadLimit one(1);
        const Points alone = sample(24);
        EXPECT_EQ(points.position, alone.position);
        EXPECT_EQ(points.velocity, alone.velocity);
    }
    EXPECT_NE(points.position, sample(24, 2).position);
    EXPECT_THROW((void)sample(7), Error);
    EXPECT_THROW((void)sample(513), Error);
}

}  // namespace
}  // namespace vog
