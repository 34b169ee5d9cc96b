// error_views_test.cpp: cropped depth images, and errors attributed to single Gaussians.
#include "compare/error_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <span>
#include <vector>

#include "render/pixel_tiles.h"
#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "vog/convert_moments.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/sample.h"

namespace vog {

using namespace comparison;
namespace {

TEST(error_views, cropped_rows_return_every_pixel) {
    DepthImage image(5, 3);
    image.at(1, 0) = 2, image.at(3, 0) = 1, image.at(4, 2) = 3;
    const CroppedDepth cropped(image);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) EXPECT_EQ(cropped.at(x, y), image.at(x, y));
}

TEST(error_views, a_spoiled_gaussian_has_the_largest_error) {
    const Volume volume = sample_explosion({.size = 64});
    MomentOptions options;
    options.block_voxels = 8;
    Gaussians model = convert_moments(volume, options);
    const ErrorViews views(model);  // its own reference: no error yet
    for (const float error : views.error_of_each_gaussian(model)) ASSERT_LT(error, 1e-9f);
    EXPECT_LT(views.visible_rms(model), 1e-6);
    const std::size_t spoiled = model.size() / 2;
    model.density[spoiled] *= 3;
    EXPECT_GT(views.visible_rms(model), 1e-4);
    const std::vector<float> errors = views.error_of_each_gaussian(model);
    EXPECT_EQ(std::ranges::max_element(errors) - errors.begin(),
              static_cast<std::ptrdiff_t>(spoiled));
}

TEST(error_views, each_pixel_has_one_of_the_fifth_at_or_beside_it) {
    for (int y = 1; y < 12; ++y)
        for (int x = 1; x < 12; ++x)
            EXPECT_EQ(is_fifth(x, y) + is_fifth(x - 1, y) + is_fifth(x + 1, y) +
                          is_fifth(x, y - 1) + is_fifth(x, y + 1),
                      1);
}

TEST(error_views, a_fifth_of_the_rays_are_those_of_the_whole_picture) {
    const Volume volume = sample_explosion({.size = 64});
    const Camera camera = error_views(world_box(volume)).front();
    const VoxelGrid grid = voxel_grid(volume, {Interpolation::linear, 0});
    ReferenceOptions fifth;
    fifth.fifth = true;
    const DepthImage whole = render_reference(std::span(&grid, 1), camera, 64, 64);
    const DepthImage part = render_reference(std::span(&grid, 1), camera, 64, 64, fifth);
    const auto sum = [](const DepthImage& image) {
        return std::accumulate(image.depth.begin(), image.depth.end(), 0.0);
    };
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
            EXPECT_EQ(part.at(x, y), is_fifth(x, y) ? whole.at(x, y) : 0.0f);
    EXPECT_NEAR(5 * sum(part), sum(whole), 0.02 * sum(whole));
}

/// One voxel far away makes the box of the data 3000 times as large as all else.
Volume cloud_with_a_stray_voxel() {
    Volume volume = sample_cloud({.size = 64});
    Leaf stray;
    stray.origin = {100000, 0, 0};
    stray.set(0, 0.001f);
    volume.leaves.push_back(stray);
    return volume;
}

TEST(error_views, are_framed_by_the_mass_where_one_voxel_is_far_away) {
    const Volume alone = sample_cloud({.size = 64}), stray = cloud_with_a_stray_voxel();
    const std::span<const Volume> one(&alone, 1), both(&stray, 1);
    EXPECT_EQ(error_view_box(one, world_box(alone)), world_box(alone));
    const Box box = error_view_box(both, world_box(stray));
    EXPECT_LT(box.radius(), 2 * world_box(alone).radius());
    EXPECT_LT(length(box.center() - world_box(alone).center()), world_box(alone).radius());
    // The default conversion sees the cloud, and so needs more than one Gaussian for it.
    MomentReport report;
    const Gaussians model = convert_moments(stray, {}, &report);
    EXPECT_GT(model.size(), 100u);
    EXPECT_GT(report.measured_error, 0);
}

TEST(error_views, an_error_of_nothing_visible_is_refused) {
    SquareSums sums;
    sums.add(5, 0);  // a plate edge-on, which a model is drawn wider than
    EXPECT_THROW((void)sums.error(), Error);
    sums.add(0.01, 1), sums.add(0.09, 1);
    EXPECT_DOUBLE_EQ(sums.error().worst, 0.3);
    EXPECT_DOUBLE_EQ(sums.error().mean, std::sqrt(0.05));
    // Two voxels 5e8 apart: no pixel of the whole meets one, so that one of them is viewed.
    Volume two;
    two.leaves.resize(2);
    two.leaves[1].origin = {400000000, 0, 0};
    for (Leaf& leaf : two.leaves) leaf.set(0, 1);
    MomentOptions options;
    options.error = 0.5;
    MomentReport report;
    EXPECT_EQ(convert_moments(two, options, &report).size(), 2u);
    EXPECT_GT(report.measured_error, 0);
}

/// What `error` promises: no view is worse. Twenty that the search does not use.
TEST(error_views, the_measured_error_holds_for_views_that_were_not_measured) {
    const Volume volume = sample_cloud({.size = 64});
    MomentOptions options;
    options.error = 0.1;
    MomentReport report;
    const Gaussians model = convert_moments(volume, options, &report);
    EXPECT_LE(report.measured_error, options.error);
    EXPECT_LT(report.mean_error, report.measured_error);
    const VoxelGrid grid = voxel_grid(volume);
    std::mt19937 random(7);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    };
    constexpr double kTolerance = 1.15;
    for (int view = 0; view < 20; ++view) {
        Orbit orbit;
        orbit.azimuth_degrees = uniform(0, 360);
        orbit.elevation_degrees = 57.3 * std::asin(uniform(-1, 1));
        orbit.distance_radii = std::exp(uniform(std::log(1.5), std::log(20)));
        orbit.fov_degrees = uniform(20, 45);
        orbit.orthographic = view % 4 == 3;
        const Camera camera = orbit_view(world_box(volume), orbit);
        const DepthImage exact = render_reference(std::span(&grid, 1), camera, 200, 200);
        const DepthImage image = render_splat(model, camera, 200, 200);
        double error2 = 0, norm2 = 0;
        for (std::size_t n = 0; n < exact.depth.size(); ++n) {
            const double t = exact.depth[n], d = image.depth[n] - t;
            error2 += d * d, norm2 += t * t;
        }
        EXPECT_LE(std::sqrt(error2 / norm2), kTolerance * options.error) << view;
    }
}

}  // namespace
}  // namespace vog
