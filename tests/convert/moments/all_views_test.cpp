// all_views_test.cpp: models from the axes of the grid, its diagonals, near and far: no grid of dots.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "support/data.h"
#include "support/moment_volumes.h"
#include "support/view_errors.h"
#include "vog/convert_moments.h"
#include "vog/sample.h"
#include "vog/volume_io.h"

namespace vog {
namespace {

MomentOptions uniform(int block) {
    MomentOptions options;
    options.block_voxels = block;
    return options;
}

/// Root mean square of T / T_exact, relative to its mean, over parallel rays through the middle of
/// the data.
double ripple(const Gaussians& model, const VoxelGrid& exact, Vec3d middle, Vec3d direction,
              double width) {
    const Vec3d forward = (1 / length(direction)) * direction;
    Camera camera;
    // From so far that rays of one picture are parallel to within 0.1 degrees.
    constexpr double kDistance = 1000;
    camera.eye = middle - kDistance * width * forward;
    camera.look_at = middle;
    camera.up = std::abs(forward.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    camera.fov_degrees = 2 * std::atan(0.5 / kDistance) * 180 / std::numbers::pi;
    constexpr int kSize_px = 96;
    const DepthImage image = render_splat(model, camera, kSize_px, kSize_px);
    const DepthImage truth = render_reference(std::span(&exact, 1), camera, kSize_px, kSize_px);
    double sum = 0, sum2 = 0;
    for (std::size_t n = 0; n < image.depth.size(); ++n) {
        const double ratio = double{image.depth[n]} / truth.depth[n];
        sum += ratio, sum2 += ratio * ratio;
    }
    const double count = static_cast<double>(image.depth.size()), mean = sum / count;
    return std::sqrt(std::max(0.0, sum2 / count - mean * mean)) / mean;
}

/// Largest ripple of a cube of 64^3 voxels of constant density over the 13 lattice directions.
double largest_ripple(int block, int soft_steps) {
    Volume cube;
    for (int n = 0; n < 512; ++n) {
        Leaf& leaf = cube.leaves.emplace_back();
        leaf.origin = {8 * (n >> 6), 8 * (n >> 3 & 7), 8 * (n & 7)};
        for (int v = 0; v < kLeafVoxels; ++v) leaf.set(v, 0.7f);
    }
    MomentOptions options = uniform(block);
    options.soft_steps = soft_steps;
    const Gaussians model = convert_moments(cube, options);
    const VoxelGrid exact = voxel_grid(cube);
    double largest = 0;
    for (int n = 14; n < 27; ++n) {
        const Vec3d direction{double(n / 9 - 1), double(n / 3 % 3 - 1), double(n % 3 - 1)};
        // Two cells wide, in the middle: the ends of the rays lie on the faces of the cube.
        const double width = 2 * block;
        largest = std::max(largest, ripple(model, exact, {31.5, 31.5, 31.5}, direction, width));
    }
    return largest;
}

TEST(all_views, a_constant_field_is_flat_along_axes_and_diagonals) {
    for (const int block : {1, 2, 4, 8}) EXPECT_LT(largest_ripple(block, -1), 0.03) << block;
    // Hard cells: 27 % by the closed form in overlapping_cells.h.
    EXPECT_NEAR(largest_ripple(4, 0), 0.274, 0.02);
}

TEST(all_views, overlapping_cells_conserve_mass_mean_and_covariance) {
    for (const std::uint64_t seed : {41, 42, 43}) {
        const Volume volume = test::random_volume(seed, 0.04 * static_cast<double>(seed - 40));
        ASSERT_FALSE(volume.tiles.empty());
        const auto whole = [&](int soft_steps, int block) {
            MomentOptions options = uniform(block);
            options.mass_threshold = 0;
            options.soft_steps = soft_steps;
            return convert_moments(volume, options);
        };
        const auto moments_of = [](const Gaussians& model) {
            double sum = 0;
            Vec3d first;
            Mat3 second{{Vec3d{}, Vec3d{}, Vec3d{}}};
            for (std::size_t i = 0; i < model.size(); ++i) {
                const double m = mass(model, i);
                const Vec3d at = vec_cast<double>(model.mean[i]);
                const Mat3 c = test::covariance(model, i);
                sum += m, first = first + m * at;
                for (int row = 0; row < 3; ++row)
                    for (int column = 0; column < 3; ++column)
                        second(row, column) += m * (c(row, column) + at[row] * at[column]);
            }
            std::vector<double> all{sum, first.x / sum, first.y / sum, first.z / sum};
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 3; ++column) all.push_back(second(row, column) / sum);
            return all;
        };
        const double radius = world_box(volume).radius() + length(world_box(volume).center());
        for (const int block : {1, 2}) {
            const Gaussians hard = whole(0, block), soft = whole(-1, block);
            EXPECT_EQ(hard.size(), soft.size()) << "windows make no cells";
            const auto a = moments_of(hard), b = moments_of(soft);
            EXPECT_NEAR(b[0] / a[0], 1, 1e-6);
            // Cells of one voxel are wider than their voxels.
            for (std::size_t n = 1; n < (block == 1 ? 4 : a.size()); ++n)
                EXPECT_NEAR(a[n], b[n], 1e-5 * (n < 4 ? radius : radius * radius)) << n;
        }
        EXPECT_NEAR(moments_of(whole(-1, 4))[0] / mass(volume), 1, 1e-6);
        EXPECT_NEAR(moments_of(whole(-1, 8))[0] / mass(volume), 1, 1e-6);
    }
}

/// Largest ratio of a view's error to that of the paper's view.
constexpr double kOverPaper = 2.5;
/// A view may instead have this multiple of the error that interpolation between the centres of
/// voxels has: along an axis the faces of voxels line up, which no smooth field has.
constexpr double kOverFaces = 1.5;

void expect_even(std::span<const test::ExactView> views, const Volume& volume,
                 const MomentOptions& options) {
    const Gaussians model = convert_moments(volume, options);
    const std::vector<double> errors = test::view_errors(views, model);
    for (std::size_t n = 0; n < views.size(); ++n)
        EXPECT_LE(errors[n], std::max(kOverPaper * errors[0], kOverFaces * views[n].faces))
            << volume.source << " " << model.options << ": " << views[n].name << ", paper view "
            << errors[0] << ", faces " << views[n].faces;
}

MomentOptions a_fiftieth(const Volume& volume) {
    MomentOptions options;
    options.budget = active_voxels(volume) / 50;
    return options;
}

TEST(all_views, no_view_is_much_worse_than_the_papers) {
    for (const Volume& volume : {sample_cloud({.size = 64}), sample_explosion({.size = 64})}) {
        const auto views = test::exact_views(volume, {.size_px = 64});
        for (const int block : {2, 4, 8}) expect_even(views, volume, uniform(block));
        expect_even(views, volume, a_fiftieth(volume));
        expect_even(views, volume, {});
    }
}

/// Along an axis the faces of voxels line up in rays, for any smooth field; a pixel's mean sees the model alone.
TEST(all_views, real_data_in_4_voxel_cells_are_within_6_percent) {
    VOG_NEEDS_DATA("smoke.vdb");
    const Volume volume = read_volume(test::data_dir() / "smoke.vdb");
    const Gaussians model = convert_moments(volume, uniform(4));
    constexpr double kOverSmooth = 1.3;
    for (const test::ExactViewOptions& options :
         {test::ExactViewOptions{.size_px = 224, .faces = false},
          test::ExactViewOptions{
              .size_px = 112, .samples = 2, .faces = false, .orthographic = true},
          test::ExactViewOptions{.size_px = 160, .orthographic = true}}) {
        const auto views = test::exact_views(volume, options);
        const std::vector<double> errors = test::view_errors(views, model);
        for (std::size_t n = 0; n < views.size(); ++n) {
            EXPECT_LE(errors[n], std::max(0.06, kOverSmooth * views[n].faces))
                << views[n].name << ", " << options.samples << " samples, faces " << views[n].faces;
            EXPECT_LE(errors[n], std::max(kOverPaper * errors[0], kOverSmooth * views[n].faces))
                << views[n].name << ", paper view " << errors[0];
        }
    }
}

TEST(all_views, no_view_of_real_data_is_much_worse) {
    VOG_NEEDS_DATA("smoke.vdb");
    // Smoke is the largest: its default cut alone, the one with most Gaussians.
    const Volume smoke = read_volume(test::data_dir() / "smoke.vdb");
    expect_even(test::exact_views(smoke), smoke, {});
    for (const char* name : {"cloud.vdb", "beetle.vdb"}) {
        const Volume volume = read_volume(test::data_dir() / name);
        const auto views = test::exact_views(volume, {.size_px = 64});
        expect_even(views, volume, uniform(2));
        expect_even(views, volume, a_fiftieth(volume));
        expect_even(views, volume, {});
    }
}

}  // namespace
}  // namespace vog
