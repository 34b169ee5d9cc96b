// coarsen_test.cpp: moments, counts and pictures of coarsened models.
#include "vog/lod.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/splat/splat.h"
#include "support/moment_volumes.h"
#include "support/scenes.h"
#include "vog/compare.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/ply.h"
#include "vog/sample.h"

namespace vog::test {

namespace {

/// Mass, mean and covariance of a whole model, after truncation.
struct Whole {
    double mass = 0;
    Vec3d mean;
    Mat3 covariance{{Vec3d{}, {}, {}}};
};
Whole whole(const Gaussians& model) {
    Whole sum;
    for (std::size_t i = 0; i < model.size(); ++i) {
        sum.mass += mass(model, i);
        sum.mean = sum.mean + mass(model, i) * vec_cast<double>(model.mean[i]);
    }
    sum.mean = (1 / sum.mass) * sum.mean;
    for (std::size_t i = 0; i < model.size(); ++i) {
        const double share = mass(model, i) / sum.mass;
        const Vec3d d = vec_cast<double>(model.mean[i]) - sum.mean;
        const Mat3 own = covariance(model, i);
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) sum.covariance(r, c) += share * (own(r, c) + d[r] * d[c]);
    }
    return sum;
}

/// Sums over thousands of single-precision Gaussians.
constexpr double kTolerance = 2e-5;

void expect_same_moments(const Gaussians& coarse, const Gaussians& fine) {
    const Whole a = whole(coarse), b = whole(fine);
    EXPECT_NEAR(a.mass, b.mass, kTolerance * b.mass);
    const double spread = std::sqrt(b.covariance(0, 0) + b.covariance(1, 1) + b.covariance(2, 2));
    EXPECT_NEAR(length(a.mean - b.mean), 0, kTolerance * spread);
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(a.covariance(r, c), b.covariance(r, c), kTolerance * spread * spread);
}

}  // namespace

TEST(coarsen, mass_mean_and_covariance_are_conserved) {
    for (const float cutoff : {1.5f, 2.25f, 3.03f}) {
        const Gaussians model = random_gaussians(3000, 0.01, 0.1, 7, cutoff);
        for (const std::size_t budget : {1u, 2u, 40u, 1000u, 2999u}) {
            const Gaussians coarse = coarsen(model, budget);
            EXPECT_LE(coarse.size(), budget);
            EXPECT_GE(coarse.size(), budget - budget / 10);
            EXPECT_EQ(coarse.cutoff, cutoff);
            expect_same_moments(coarse, model);
            EXPECT_NO_THROW(validate(coarse));
        }
    }
}

TEST(coarsen, two_become_the_one_that_has_their_moments) {
    Gaussians model;
    add(model, {-1, 0, 0}, {1, 1, 1}, 2);
    add(model, {3, 0, 0}, {1, 1, 1}, 2);
    const Gaussians one = coarsen(model, 1);
    ASSERT_EQ(one.size(), 1u);
    EXPECT_NEAR(one.mean[0].x, 1, 1e-6);
    // Along x the variance of the masses' places, 4, is added to their own, P5/P3.
    const double own = variance_within(model.cutoff);
    const double largest = std::max({one.scale[0].x, one.scale[0].y, one.scale[0].z});
    EXPECT_NEAR(largest * largest * own, own + 4, 1e-5);
    EXPECT_NEAR(mass(one), mass(model), 1e-6 * mass(model));
}

TEST(coarsen, a_budget_that_is_met_gives_the_model_itself) {
    const Gaussians model = random_gaussians(50, 0.05, 0.2, 3);
    const Gaussians same = coarsen(model, 50);
    EXPECT_EQ(same.mean, model.mean);
    EXPECT_EQ(same.rotation, model.rotation);
    EXPECT_EQ(coarsen(Gaussians{}, 10).size(), 0u);
}

TEST(coarsen, survives_one_place_no_mass_and_extreme_units) {
    Gaussians heap;
    for (int n = 0; n < 100; ++n) add(heap, {5, 5, 5}, {0.1f, 0.2f, 0.3f}, 1);
    expect_same_moments(coarsen(heap, 3), heap);

    Gaussians partly;
    for (int n = 0; n < 100; ++n) add(partly, {float(n), 0, 0}, {1, 1, 1}, n % 2 ? 1.0f : 0.0f);
    expect_same_moments(coarsen(partly, 10), partly);
    for (float& density : partly.density) density = 0;
    EXPECT_EQ(coarsen(partly, 10).size(), 0u);

    for (const double unit : {1e-6, 1e9}) {
        Gaussians model = random_gaussians(500, 0.01, 0.1, 5);
        for (std::size_t i = 0; i < model.size(); ++i) {
            model.mean[i] = static_cast<float>(unit) * model.mean[i];
            model.scale[i] = static_cast<float>(unit) * model.scale[i];
        }
        expect_same_moments(coarsen(model, 50), model);
    }
}

TEST(coarsen, refuses_a_budget_of_nothing) {
    EXPECT_THROW((void)coarsen(random_gaussians(5, 0.1, 0.2, 1), 0), Error);
}

TEST(coarsen, levels_are_a_quarter_each_and_end_near_a_thousand) {
    const auto levels = detail_levels(random_gaussians(40000, 0.01, 0.03, 11));
    ASSERT_EQ(levels.size(), 4u);
    for (std::size_t n = 1; n < levels.size(); ++n) {
        EXPECT_LE(4 * levels[n].size(), levels[n - 1].size() + 3);
        EXPECT_GE(5 * levels[n].size(), levels[n - 1].size());
        expect_same_moments(levels[n], levels[0]);
    }
    EXPECT_EQ(detail_levels(random_gaussians(40000, 0.01, 0.03, 11), 2).size(), 2u);
    EXPECT_EQ(detail_levels(random_gaussians(900, 0.01, 0.1, 2)).size(), 1u);
    EXPECT_EQ(detail_levels(Gaussians{}).size(), 1u);
}

/// Compared with thinning: every fourth Gaussian with four times the density.
TEST(coarsen, pictures_stay_close) {
    const Gaussians model =
        convert_moments(sample_cloud({.size = 96}), {.block_voxels = 2, .soft_steps = 0});
    const Camera camera = paper_view(model.box);
    DepthImage reference = render_splat(model, camera, 128, 128);
    set_extinction(reference, auto_extinction(reference));
    const auto psnr = [&](const Gaussians& other) {
        return compare(reference, render_splat(other, camera, 128, 128)).grey.psnr_db;
    };
    Gaussians thinned;
    thinned.box = model.box;
    for (std::size_t i = 0; i < model.size(); i += 4)
        add(thinned, model.mean[i], model.scale[i], 4 * model.density[i], model.rotation[i]);
    const double quarter = psnr(coarsen(model, model.size() / 4));
    EXPECT_GT(quarter, 40);
    EXPECT_GT(quarter, psnr(thinned) + 10);
    EXPECT_GT(psnr(coarsen(model, model.size() / 16)), 37);
}

}  // namespace vog::test
