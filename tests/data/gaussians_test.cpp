// gaussians_test.cpp: mass, bounds and joining of models.
#include "vog/gaussians.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace vog::test
