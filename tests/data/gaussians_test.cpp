// gaussians_test.cpp: mass, bounds and joining of models.
#include "vog/gaussians.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/error.h"

namespace vog::test {

TEST(gaussians, truncation_constants_are_those_of_the_chi_square_distributions) {
    // Chi-square distribution functions: P3 = 0.8327 and P5 / P3 = 0.7106 at k = 2.25; 1 - P3 = 2.9
    // % at 3.
    EXPECT_NEAR(mass_within(2.25), 0.8327, 5e-5);
    EXPECT_NEAR(variance_within(2.25), 0.7106, 5e-5);
    EXPECT_NEAR(mass_within(3), 0.971, 5e-4);
    EXPECT_NEAR(mass_within(8), 1, 1e-12);
    EXPECT_NEAR(variance_within(8), 1, 1e-10);
}

TEST(gaussians, mass_equals_the_integral_of_the_density) {
    Gaussians model;
    add(model, {0.1f, 0.2f, 0.3f}, {0.5f, 0.7f, 0.9f}, 2, {0.8f, 0.3f, -0.4f, 0.33f});
    // Midpoint sum over the box of the support; the kernel's jump at the cutoff limits its order to
    // h.
    const Box box = support_box(model, 0);
    const Mat3 w = whitening(model, 0);
    constexpr int kSteps = 120;
    const Vec3d step = (1.0 / kSteps) * (box.upper - box.lower);
    double sum = 0;
    for (int x = 0; x < kSteps; ++x)
        for (int y = 0; y < kSteps; ++y)
            for (int z = 0; z < kSteps; ++z) {
                const Vec3d p =
                    box.lower + Vec3d{(x + 0.5) * step.x, (y + 0.5) * step.y, (z + 0.5) * step.z};
                const Vec3d u = w * (p - vec_cast<double>(model.mean[0]));
                if (dot(u, u) <= 2.25 * 2.25) sum += 2 * std::exp(-0.5 * dot(u, u));
            }
    EXPECT_NEAR(sum * step.x * step.y * step.z, mass(model), 1e-3 * mass(model));
}

TEST(gaussians, support_box_touches_the_ellipsoid) {
    const Gaussians model = random_gaussians(20, 0.05, 0.5, 3);
    Random random(4);
    for (std::size_t i = 0; i < model.size(); ++i) {
        const Box box = support_box(model, i);
        const Mat3 r = matrix_from_quat(model.rotation[i]);
        const Vec3d s = vec_cast<double>(model.scale[i]);
        Box sampled;
        for (int n = 0; n < 20000; ++n) {
            const Vec3d u = normalized(random.in_cube(1));
            sampled.include(vec_cast<double>(model.mean[i]) +
                            r * (2.25 * Vec3d{u.x * s.x, u.y * s.y, u.z * s.z}));
        }
        for (int axis = 0; axis < 3; ++axis) {
            // The extreme of 20,000 random points is within a few thousandths of the bound.
            EXPECT_LE(box.lower[axis], sampled.lower[axis] + 1e-6);
            EXPECT_GE(box.upper[axis], sampled.upper[axis] - 1e-6);
            EXPECT_NEAR(box.upper[axis], sampled.upper[axis], 5e-3);
        }
    }
}

TEST(gaussians, append_keeps_mass_and_gives_rotations_to_all) {
    Gaussians plain, turned = random_gaussians(5, 0.1, 0.2, 6);
    plain.source = "a.vdb density";
    add(plain, {0, 0, 0}, {1, 1, 1}, 1);
    plain.box = {{-1, -1, -1}, {1, 1, 1}};
    turned.box = {{0, 0, 0}, {3, 1, 1}};
    Gaussians both = plain;
    append(both, turned);
    validate(both);
    EXPECT_EQ(both.size(), 6u);
    EXPECT_EQ(both.rotation[0], Quat{});
    EXPECT_EQ(both.rotation[5], turned.rotation[4]);
    EXPECT_DOUBLE_EQ(mass(both), mass(plain) + mass(turned));
    EXPECT_EQ(both.box, (Box{{-1, -1, -1}, {3, 1, 1}}));

    Gaussians other = turned;
    other.cutoff = 3;
    EXPECT_THROW(append(both, other), Error);
}

TEST(gaussians, origin_is_that_of_a_box_far_from_0) {
    const auto cube = [](Vec3d center, double half) {
        return Box{center - Vec3d{half, half, half}, center + Vec3d{half, half, half}};
    };
    EXPECT_EQ(model_origin({}), Vec3d{});
    EXPECT_EQ(model_origin(cube({0, 0, 0}, 1e9)), Vec3d{});
    EXPECT_EQ(model_origin(cube({50, 0, 0}, 1)), Vec3d{});
    // A power of two near the radius, 1.7: a multiple of 1; of a radius of 173: of 128.
    EXPECT_EQ(model_origin(cube({60.3, 1.2, -0.4}, 1)), (Vec3d{60, 1, 0}));
    EXPECT_EQ(model_origin(cube({5000000.1, 1e9, -7}, 100)), (Vec3d{5000064, 1e9, 0}));
    EXPECT_EQ(model_origin(cube({0.1, 1e-3, 7e15}, 0)), (Vec3d{0.1, 1e-3, 7e15}));
    EXPECT_EQ(model_origin(cube({1e300, 0, 0}, 1e-300)), (Vec3d{1e300, 0, 0}));
}

TEST(gaussians, another_origin_leaves_them_where_they_are) {
    Gaussians model = random_gaussians(20, 0.05, 0.5, 8);
    model.origin = {1e9, 5000000.1, -3};
    const Gaussians before = model;
    set_origin(model, {1e9 - 4, 5000000, 0});
    for (std::size_t i = 0; i < model.size(); ++i) {
        EXPECT_LT(length(world_mean(model, i) - world_mean(before, i)), 1e-6);
        EXPECT_LT(length(support_box(model, i).lower - support_box(before, i).lower), 1e-6);
    }
    EXPECT_EQ(view_box(select(model, std::vector<std::size_t>{3})), support_box(model, 3));
    EXPECT_THROW(set_origin(model, {}), Error);  // floats near 1e9 are 64 apart
    EXPECT_EQ(model.origin, (Vec3d{1e9 - 4, 5000000, 0}));
    model.origin.y = NAN;
    EXPECT_THROW(validate(model), Error);
}

TEST(gaussians, append_gives_models_of_two_origins_one) {
    Gaussians a = random_gaussians(20, 0.05, 0.5, 9), b = a;
    a.origin = {1e9, 0, 0}, b.origin = {1e9 + 30, 1, 0};
    Gaussians both = a;
    append(both, b);
    validate(both);
    ASSERT_EQ(both.size(), 40u);
    for (std::size_t i = 0; i < 20; ++i) {
        EXPECT_LT(length(world_mean(both, i) - world_mean(a, i)), 1e-5);
        EXPECT_LT(length(world_mean(both, 20 + i) - world_mean(b, i)), 1e-5);
    }
    EXPECT_LT(std::abs(both.origin.x - 1e9), 100);

    Gaussians near = random_gaussians(20, 0.05, 0.5, 10);
    const Gaussians unchanged = near;
    EXPECT_THROW(append(near, a), Error);  // 1e9 apart: floats cannot hold both
    EXPECT_EQ(near.mean, unchanged.mean);
}

TEST(gaussians, select_takes_any_in_any_order_and_keeps_the_view) {
    Gaussians model;
    for (int i = 0; i < 5; ++i)
        add(model, {float(i), 0, 0}, {1, 2, 3}, 1 + float(i), {1, float(i), 0, 0});
    model.box = {{-1, -1, -1}, {9, 9, 9}};
    model.cutoff = 3;
    const std::size_t index[] = {4, 0, 4};
    const Gaussians some = select(model, index);
    EXPECT_EQ(some.density, (BigVector<float>{5, 1, 5}));
    EXPECT_EQ(some.rotation[2], model.rotation[4]);
    EXPECT_EQ(some.box, model.box);
    EXPECT_EQ(some.cutoff, 3);
    EXPECT_EQ(select(model, {}).size(), 0u);
    model.rotation.clear();
    EXPECT_TRUE(select(model, index).axis_aligned());
    const std::size_t beyond[] = {5};
    EXPECT_THROW((void)select(model, beyond), Error);
}

TEST(gaussians, validate_names_the_first_offence) {
    const auto message = [](auto&& spoil) {
        Gaussians model = random_gaussians(3, 0.1, 0.2, 7);
        spoil(model);
        try {
            validate(model);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_EQ(message([](Gaussians&) {}), "no error");
    EXPECT_NE(message([](Gaussians& m) { m.scale[1].y = 0; }).find("Gaussian 1: scales"),
              std::string::npos);
    EXPECT_NE(message([](Gaussians& m) { m.density[2] = -1; }).find("Gaussian 2: density"),
              std::string::npos);
    EXPECT_NE(message([](Gaussians& m) { m.mean[0].z = NAN; }).find("Gaussian 0: mean "),
              std::string::npos);
    EXPECT_NE(message([](Gaussians& m) {
                  m.rotation[1] = {0, 0, 0, 0};
              }).find("Gaussian 1: rotation"),
              std::string::npos);
    EXPECT_NE(message([](Gaussians& m) { m.density.pop_back(); }).find("different lengths"),
              std::string::npos);
    EXPECT_NE(message([](Gaussians& m) { m.cutoff = 0; }).find("cutoff 0"), std::string::npos);
}

TEST(gaussians, box_of_a_model_without_one_is_that_of_its_supports) {
    Gaussians model;
    add(model, {1, 0, 0}, {1, 1, 1}, 1);
    EXPECT_DOUBLE_EQ(view_box(model).upper.x, 3.25);
    model.box = {{0, 0, 0}, {1, 1, 1}};
    EXPECT_EQ(view_box(model), model.box);
}

TEST(gaussians, the_first_of_many_out_of_range_is_named) {
    // Blocks of 2^14 are looked at side by side.
    Gaussians model = random_gaussians(100000, 0.02, 0.2, 4);
    for (const std::size_t i : {99000u, 70001u, 40007u, 40006u}) {
        model.density[i] = -1;
        EXPECT_NE(refusal([&] {
                      validate(model);
                  }).find("Gaussian " + std::to_string(i) + ": density -1"),
                  std::string::npos)
            << i;
    }
}

}  // namespace vog::test
