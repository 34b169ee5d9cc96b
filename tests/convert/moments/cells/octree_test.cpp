// octree_test.cpp: the octree's sums, the cuts through it, soft cells, the measured error.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "convert/moments/gaussian_moments.h"
#include "support/data.h"
#include "support/moment_volumes.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/progress.h"
#include "vog/reference.h"
#include "vog/splat.h"
#include "vog/volume_io.h"

namespace vog {

using namespace moments;
namespace {

using test::random_volume;
using test::VolumeMaker;

MomentSums about_origin(const MomentCell& cell, int edge_log2) {
    Moments moments;
    moments.mass = cell.mass;
    const double half = 0.5 * (std::ldexp(1.0, edge_log2) - 1);
    moments.mean =
        vec_cast<double>(cell.origin) + Vec3d{half, half, half} + vec_cast<double>(cell.mean);
    for (std::size_t n = 0; n < 6; ++n) moments.covariance[n] = cell.covariance[n];
    return sums_of(moments);
}

void expect_same_sums(const MomentSums& a, const MomentSums& b, double scale) {
    // Cells are float32; second moments about the origin grow with the distance squared.
    const double tolerance = 3e-7 * a.mass;
    EXPECT_NEAR(a.mass, b.mass, tolerance);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(a.first[axis], b.first[axis], tolerance * scale);
    for (std::size_t n = 0; n < 6; ++n)
        EXPECT_NEAR(a.second[n], b.second[n], tolerance * scale * scale);
}

TEST(moment_octree, a_parents_moments_are_the_sum_of_its_childrens) {
    for (const int finest : {1, 2, 4, 8}) {
        const MomentOctree octree = moment_octree(random_volume(21, 0.05), finest);
        ASSERT_GT(octree.levels.size(), 3u);
        EXPECT_EQ(octree.levels.back().cells.size(), 1u);
        for (std::size_t level = 1; level < octree.levels.size(); ++level) {
            const MomentLevel &at = octree.levels[level], &finer = octree.levels[level - 1];
            std::uint32_t next = 0;
            for (const MomentCell& cell : at.cells) {
                if (cell.child_count == 0) continue;
                EXPECT_EQ(cell.first_child, next);  // children are contiguous, and all have parents
                next += cell.child_count;
                MomentSums sum;
                for (std::uint32_t child = 0; child < cell.child_count; ++child)
                    add_shifted(
                        sum, about_origin(finer.cells[cell.first_child + child], finer.edge_log2),
                        {});
                expect_same_sums(about_origin(cell, at.edge_log2), sum, 512);
            }
            EXPECT_EQ(next, finer.cells.size());
        }
    }
}

TEST(moment_octree, its_root_has_the_whole_mass_on_either_side_of_zero) {
    const Volume volume = random_volume(22, 0.05);
    const MomentOctree octree = moment_octree(volume);
    EXPECT_NEAR(octree.levels.back().cells[0].mass * voxel_volume(volume) / mass(volume), 1, 1e-6);
    const std::uint32_t root = 0;
    const Gaussians model = cell_gaussians(octree, octree.levels.size() - 1, {&root, 1});
    EXPECT_NEAR(mass(model) / mass(volume), 1, 1e-6);
    EXPECT_TRUE(moment_octree(Volume{}).levels.empty());
    EXPECT_THROW((void)moment_octree(volume, 3), Error);
}

TEST(moment_octree, a_level_is_the_uniform_cut_of_its_size) {
    VolumeMaker maker;
    maker.box({-9, -3, 0}, {20, 17, 5}, 0.4f);
    const Volume volume = maker.finish();
    const MomentOctree octree = moment_octree(volume, 2);
    for (std::size_t level = 0; octree.levels[level].edge_log2 <= 4; ++level) {
        std::vector<std::uint32_t> all(octree.levels[level].cells.size());
        for (std::uint32_t n = 0; n < all.size(); ++n) all[n] = n;
        const Gaussians cells = cell_gaussians(octree, level, all);
        MomentOptions options;
        options.block_voxels = 1 << octree.levels[level].edge_log2;
        options.mass_threshold = 0;
        const Gaussians model = convert_moments(volume, options);
        ASSERT_EQ(cells.size(), model.size());
        for (std::size_t i = 0; i < model.size(); ++i) {
            EXPECT_NEAR(cells.mean[i].x, model.mean[i].x, 1e-5);
            EXPECT_NEAR(cells.scale[i].x, model.scale[i].x, 1e-5);
            EXPECT_NEAR(mass(cells, i), mass(model, i), 1e-5 * mass(model, i));
        }
    }
}

std::vector<char> bytes_of(const Gaussians& model) {
    std::vector<char> bytes;
    const auto add = [&](const auto& values) {
        const auto* first = reinterpret_cast<const char*>(values.data());
        bytes.insert(bytes.end(), first, first + values.size() * sizeof(values[0]));
    };
    add(model.mean), add(model.scale), add(model.rotation), add(model.density);
    return bytes;
}

TEST(moment_octree, any_number_of_threads_gives_the_same_bytes) {
    const Volume volume = random_volume(23, 0.05);
    std::vector<MomentOptions> all(5);
    all[0].block_voxels = 2;
    all[1].block_voxels = 16;
    all[2].budget = 300;
    all[3].error = 0.3;
    all[4].block_voxels = 4;
    all[4].soft_steps = 3;
    for (const MomentOptions& options : all) {
        std::vector<char> one;
        for (const int threads : {1, 2, 5}) {
            const ThreadLimit limit(threads);
            const std::vector<char> bytes = bytes_of(convert_moments(volume, options));
            if (threads == 1)
                one = bytes;
            else
                EXPECT_EQ(one, bytes);
        }
    }
}

TEST(moment_octree, a_larger_budget_is_used_and_never_exceeded) {
    const Volume volume = random_volume(24, 0.05);
    std::size_t last = 0;
    for (std::size_t budget = 1; budget < 20000; budget = 2 * budget + 1) {
        MomentOptions options;
        options.budget = budget;
        options.soft_steps = 0;
        const std::size_t count = convert_moments(volume, options).size();
        EXPECT_LE(count, budget);
        EXPECT_GE(count, last);
        if (budget < 1000) {
            EXPECT_GE(10 * (count + 8), 9 * budget);
        }
        last = count;
    }
}

TEST(moment_octree, soft_steps_keep_mass_and_mean_and_flatten_a_constant_box) {
    // Hard cells of a constant density ripple; soft ones must do so less, inside.
    VolumeMaker maker;
    maker.box({0, 0, 0}, {31, 31, 31}, 1);
    const Volume volume = maker.finish();
    const auto ripple = [&](int steps) {
        MomentOptions options;
        options.block_voxels = 8;
        options.soft_steps = steps;
        const Gaussians model = convert_moments(volume, options);
        EXPECT_NEAR(mass(model) / mass(volume), 1, 1e-5);
        Vec3d mean;
        for (std::size_t i = 0; i < model.size(); ++i)
            mean = mean + (mass(model, i) / mass(model)) * vec_cast<double>(model.mean[i]);
        for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(mean[axis], 15.5, 1e-3);
        double low = 1e9, high = 0;
        for (double y = 12; y < 20; y += 0.5)
            for (double z = 12; z < 20; z += 0.5) {
                double depth = 0;
                for (std::size_t i = 0; i < model.size(); ++i)
                    depth += optical_depth(model, i, {-50, y, z}, {1, 0, 0});
                low = std::min(low, depth), high = std::max(high, depth);
            }
        return (high - low) / 32;
    };
    const double hard = ripple(0), soft = ripple(8);
    EXPECT_GT(hard, 0.1);
    EXPECT_LT(soft, 0.6 * hard);
}

TEST(moment_octree, the_error_asked_for_holds_from_other_sides) {
    VOG_NEEDS_DATA("fire.vdb");
    VdbOptions grid;
    grid.grid = "flames";
    const Volume volume = read_vdb(test::data_dir() / "fire.vdb", grid);
    MomentOptions options;
    options.error = 0.2;
    MomentReport report;
    const Gaussians model = convert_moments(volume, options, &report);
    EXPECT_LE(report.measured_error, options.error);
    EXPECT_GT(report.measured_error, 0.8 * options.error);  // the smallest cut, not just any
    EXPECT_NE(model.options.find("measured error"), std::string::npos);
    const std::vector<VoxelGrid> grids{voxel_grid(volume)};
    double error2 = 0, norm2 = 0;
    for (int view = 0; view < 3; ++view) {
        const Camera camera = orbit_view(model.box, 1.1 + 2 * view, 0.6 - 0.5 * view, 2.5, 45);
        const DepthImage exact = render_reference(grids, camera, 160, 160);
        const DepthImage image = render_splat(model, camera, 160, 160);
        for (std::size_t n = 0; n < exact.depth.size(); ++n) {
            error2 += std::pow(double{image.depth[n]} - exact.depth[n], 2);
            norm2 += std::pow(double{exact.depth[n]}, 2);
        }
    }
    EXPECT_LT(std::sqrt(error2 / norm2), 1.2 * options.error);
}

TEST(moment_octree, an_error_out_of_reach_gives_the_finest_cut_and_says_so) {
    VolumeMaker maker;
    maker.set({0, 0, 0}, 1);
    maker.set({3, 0, 0}, 2);
    MomentReport report;
    MomentOptions options;
    options.error = 1e-6;
    const Gaussians model = convert_moments(maker.finish(), options, &report);
    EXPECT_EQ(model.size(), 2u);
    EXPECT_GT(report.measured_error, options.error);
}

}  // namespace
}  // namespace vog
