// convert_paper_test.cpp: the paper's grouping, amplitudes, thresholds and counts.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include "support/data.h"
#include "support/random_volume.h"
#include "vog/convert_paper.h"
#include "vog/error.h"
#include "vog/levels.h"
#include "vog/sample.h"
#include "vog/volume_io.h"

namespace vog {
namespace {

using test::random_volume, test::volume_of;

// Scales, peaks and positions are stored as float32, each rounded by 6e-8 of itself.
constexpr double kFloatRounding = 1e-6;
constexpr double kMassTolerance = 1e-5;

/// A group's index box: first voxel and size.
using IndexBox = std::tuple<int, int, int, int, int, int>;

/// Index boxes recovered from means and scales of a model in index units, sorted.
std::vector<IndexBox> index_boxes(const Gaussians& model) {
    std::vector<IndexBox> boxes;
    for (std::size_t i = 0; i < model.size(); ++i) {
        std::array<int, 3> lower{}, size{};
        for (int axis = 0; axis < 3; ++axis) {
            const double radius = std::sqrt(2.0) * model.scale[i][axis];
            const auto n = static_cast<std::size_t>(axis);
            size[n] = static_cast<int>(std::lround(2 * radius));
            lower[n] = static_cast<int>(std::lround(world_mean(model, i)[axis] - radius + 0.5));
        }
        boxes.emplace_back(lower[0], lower[1], lower[2], size[0], size[1], size[2]);
    }
    std::sort(boxes.begin(), boxes.end());
    return boxes;
}

/// Grouping of a sparse leaf by the paper's text: voxel by voxel, on an array of flags.
/// pairs  smart grouping; otherwise strict blocks
std::vector<IndexBox> reference_groups(const Leaf& leaf, bool pairs) {
    std::array<bool, kLeafVoxels> unused{};
    for (int n = 0; n < kLeafVoxels; ++n) unused[static_cast<std::size_t>(n)] = leaf.active(n);
    std::vector<IndexBox> groups;
    const auto take = [&](Vec3i lower, Vec3i size) {
        for (const bool mark : {false, true})
            for (int x = lower.x; x < lower.x + size.x; ++x)
                for (int y = lower.y; y < lower.y + size.y; ++y)
                    for (int z = lower.z; z < lower.z + size.z; ++z) {
                        if (x >= kLeafEdge || y >= kLeafEdge || z >= kLeafEdge) return false;
                        bool& voxel = unused[static_cast<std::size_t>(leaf_offset(x, y, z))];
                        if (!mark && !voxel) return false;
                        if (mark) voxel = false;
                    }
        const Vec3i at = leaf.origin + lower;
        groups.emplace_back(at.x, at.y, at.z, size.x, size.y, size.z);
        return true;
    };
    const auto scan = [&](int step, const std::vector<Vec3i>& sizes) {
        for (int x = 0; x < kLeafEdge; x += step)
            for (int y = 0; y < kLeafEdge; y += step)
                for (int z = 0; z < kLeafEdge; z += step)
                    for (const Vec3i size : sizes)
                        if (take({x, y, z}, size)) break;
    };
    scan(2, {{2, 2, 2}});
    if (pairs)
        scan(1, {{2, 1, 1}, {1, 2, 1}, {1, 1, 2}, {1, 1, 1}});
    else
        scan(1, {{1, 1, 1}});
    return groups;
}

Volume volume_of_voxels(const std::vector<Vec3i>& voxels, float value = 1) {
    Leaf leaf;
    for (const Vec3i voxel : voxels) leaf.set(leaf_offset(voxel.x, voxel.y, voxel.z), value);
    return volume_of({leaf});
}

PaperOptions with(Strategy strategy, Amplitude amplitude = Amplitude::mean) {
    PaperOptions options;
    options.strategy = strategy;
    options.amplitude = amplitude;
    options.opacity_threshold = 0;
    return options;
}

const std::array kStrategies = {Strategy::smart_grouping,  Strategy::strict_blocks,
                                Strategy::single_per_leaf, Strategy::variance_clusters,
                                Strategy::leaf_clusters,   Strategy::tree_mirror};

TEST(convert_paper, strategy_names_round_trip) {
    for (const Strategy strategy : kStrategies)
        EXPECT_EQ(strategy_from_name(strategy_name(strategy)), strategy);
    try {
        (void)strategy_from_name("smrt");
        FAIL() << "an unknown name was accepted";
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(),
                     "no strategy named 'smrt' (there are: smart, strict, single, variance, "
                     "neighbours, tree)");
    }
}

TEST(convert_paper, levels_are_their_parts_in_one_box) {
    const Composite data = composite({sample_levels({.size = 64}), {}});
    const Gaussians model = convert_paper(data, paper_lod(5));
    std::size_t count = 0;
    for (const Volume& part : data.parts) {
        const Gaussians one = convert_paper(part, paper_lod(5));
        ASSERT_GT(one.size(), 0u);
        EXPECT_EQ(model.mean[count], one.mean.front());
        count += one.size();
    }
    EXPECT_EQ(model.size(), count);
    EXPECT_EQ(model.box, data.box);
    EXPECT_EQ(model.source_voxels, data.voxels);
    EXPECT_THROW((void)convert_paper(Composite{}), Error);
}

TEST(convert_paper, levels_of_detail_are_the_papers) {
    const std::array blocks = {2, 4, 8, 8, 8};
    for (int lod = 1; lod <= 5; ++lod) {
        const PaperOptions options = paper_lod(lod);
        EXPECT_EQ(options.dense_block, blocks[static_cast<std::size_t>(lod) - 1]);
        EXPECT_EQ(options.strategy, lod <= 3   ? Strategy::smart_grouping
                                    : lod == 4 ? Strategy::strict_blocks
                                               : Strategy::single_per_leaf);
        EXPECT_EQ(options.amplitude, Amplitude::mean);
    }
    EXPECT_THROW((void)paper_lod(0), Error);
    EXPECT_THROW((void)paper_lod(6), Error);
}

TEST(convert_paper, dense_leaves_become_blocks_in_each_of_the_papers_strategies) {
    test::Random random(1);
    const Volume volume = volume_of({test::random_leaf(random, {8, -16, 0}, 1.1)});
    for (const int edge : {2, 4, 8})
        for (const Strategy strategy :
             {Strategy::smart_grouping, Strategy::strict_blocks, Strategy::single_per_leaf}) {
            PaperOptions options = with(strategy);
            options.dense_block = edge;
            const Gaussians model = convert_paper(volume, options);
            std::vector<IndexBox> expected;
            for (int x = 8; x < 16; x += edge)
                for (int y = -16; y < -8; y += edge)
                    for (int z = 0; z < 8; z += edge)
                        expected.emplace_back(x, y, z, edge, edge, edge);
            EXPECT_EQ(index_boxes(model), expected);
        }
}

TEST(convert_paper, smart_grouping_takes_blocks_then_pairs_along_x_y_z_then_singles) {
    std::vector<Vec3i> voxels = {{0, 0, 4}, {1, 0, 4}, {0, 1, 4},  // X before Y; (0, 1, 4) alone
                                 {4, 4, 0}, {4, 5, 0}, {4, 4, 1},  // Y before Z; (4, 4, 1) alone
                                 {6, 0, 2}, {6, 0, 3}};            // Z
    for (int n = 0; n < 8; ++n) voxels.push_back({n >> 2, (n >> 1) & 1, n & 1});  // a block
    const Volume volume = volume_of_voxels(voxels);
    const std::vector<IndexBox> expected = {{0, 0, 0, 2, 2, 2}, {0, 0, 4, 2, 1, 1},
                                            {0, 1, 4, 1, 1, 1}, {4, 4, 0, 1, 2, 1},
                                            {4, 4, 1, 1, 1, 1}, {6, 0, 2, 1, 1, 2}};
    EXPECT_EQ(index_boxes(convert_paper(volume, with(Strategy::smart_grouping))), expected);
    EXPECT_EQ(convert_paper(volume, with(Strategy::strict_blocks)).size(), 1u + 8u);
}

TEST(convert_paper, pairs_do_not_reach_around_the_ends_of_rows_and_slices) {
    // Adjacent in memory but not in space.
    for (const auto& voxels :
         {std::vector<Vec3i>{{0, 0, 7}, {0, 1, 0}}, std::vector<Vec3i>{{0, 7, 3}, {1, 0, 3}},
          std::vector<Vec3i>{{7, 7, 7}, {0, 0, 0}}})
        EXPECT_EQ(convert_paper(volume_of_voxels(voxels)).size(), 2u);
}

TEST(convert_paper, grouping_equals_the_voxel_by_voxel_reference) {
    test::Random random(7);
    for (int round = 0; round < 60; ++round) {
        const double fill = random(0.02, 0.999);
        Leaf leaf = test::random_leaf(random, {-8 * round, 8, 16}, fill);
        if (leaf.active_count() == 0 || leaf.dense()) continue;
        const Volume volume = volume_of({leaf});
        for (const bool pairs : {false, true}) {
            auto expected = reference_groups(leaf, pairs);
            std::sort(expected.begin(), expected.end());
            const auto strategy = pairs ? Strategy::smart_grouping : Strategy::strict_blocks;
            EXPECT_EQ(index_boxes(convert_paper(volume, with(strategy))), expected)
                << "fill " << fill;
        }
    }
}

TEST(convert_paper, a_single_gaussian_stands_in_the_minimum_bounding_box) {
    const Volume volume = volume_of_voxels({{1, 6, 2}, {4, 3, 2}, {2, 5, 7}}, 0.75f);
    const Gaussians model = convert_paper(volume, with(Strategy::single_per_leaf));
    EXPECT_EQ(index_boxes(model), (std::vector<IndexBox>{{1, 3, 2, 4, 4, 6}}));
    // Mean over the three active voxels, not over the 96 of the box.
    EXPECT_FLOAT_EQ(model.density[0], 0.75f);
}

TEST(convert_paper, the_mean_amplitude_is_the_mean_of_the_group) {
    Volume volume = volume_of_voxels({{3, 3, 3}, {4, 3, 3}});
    volume.leaves[0].set(leaf_offset(4, 3, 3), 4);
    const Gaussians model = convert_paper(volume);
    ASSERT_EQ(model.size(), 1u);
    EXPECT_EQ(model.density[0], 2.5f);
    EXPECT_EQ(model.mean[0], (Vec3f{3.5f, 3, 3}));
}

TEST(convert_paper, the_mass_amplitude_conserves_mass_under_every_map_and_strategy) {
    Volume volume = random_volume(3);
    for (const auto& [name, map] : test::grid_maps()) {
        volume.world_from_index = map;
        for (const Strategy strategy : kStrategies)
            for (const float radius : {0.1f, 2.5f}) {
                PaperOptions options = with(strategy, Amplitude::mass);
                options.minimum_radius_voxels = radius;
                const Gaussians model = convert_paper(volume, options);
                validate(model);
                EXPECT_NEAR(mass(model) / mass(volume), 1, kMassTolerance)
                    << name << " " << strategy_name(strategy) << " minimum radius " << radius;
            }
    }
}

TEST(convert_paper, means_and_covariances_follow_the_map) {
    Volume volume = volume_of_voxels({{2, 0, 1}, {3, 0, 1}});
    const Vec3d deviation = (1 / std::sqrt(2.0)) * Vec3d{1, 0.5, 0.5};
    for (const auto& [name, map] : test::grid_maps()) {
        volume.world_from_index = map;
        const Gaussians model = convert_paper(volume);
        ASSERT_EQ(model.size(), 1u);
        const bool aligned = name == "uniform" || name == "anisotropic" || name == "swapped";
        EXPECT_EQ(model.axis_aligned(), aligned) << name;
        EXPECT_LE(length(vec_cast<double>(model.mean[0]) - map({2.5, 0, 1})), kFloatRounding * 10);
        // L diag(s^2) L^T against R diag(scale^2) R^T.
        const Mat3 r = aligned ? Mat3{} : matrix_from_quat(model.rotation[0]);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                double expected = 0, got = 0;
                for (int k = 0; k < 3; ++k) {
                    const double s = deviation[k], scale = model.scale[0][k];
                    expected += map.linear(i, k) * s * s * map.linear(j, k);
                    got += r(i, k) * scale * scale * r(j, k);
                }
                EXPECT_NEAR(got, expected, 4 * kFloatRounding) << name << i << j;
            }
    }
}

TEST(convert_paper, a_tile_of_any_level_is_one_gaussian) {
    for (const int edge : {8, 128, 4096}) {
        Volume volume;
        volume.tiles = {{{-edge, 0, edge}, edge, 0.125f}};
        for (const Strategy strategy : kStrategies) {
            const Gaussians model = convert_paper(volume, with(strategy));
            EXPECT_EQ(index_boxes(model),
                      (std::vector<IndexBox>{{-edge, 0, edge, edge, edge, edge}}));
            EXPECT_EQ(model.density[0], 0.125f);
        }
    }
}

TEST(convert_paper, radii_are_raised_to_the_minimum) {
    PaperOptions options;
    options.minimum_radius_voxels = 0.75f;
    Volume volume = volume_of_voxels({{2, 0, 1}, {3, 0, 1}});
    volume.world_from_index.linear(1, 1) = 2;
    const Gaussians model = convert_paper(volume, options);
    const double minimum = 0.75 / std::sqrt(2.0);
    EXPECT_NEAR(model.scale[0].x, 1 / std::sqrt(2.0), kFloatRounding);
    EXPECT_NEAR(model.scale[0].y, 2 * minimum, kFloatRounding);
    EXPECT_NEAR(model.scale[0].z, minimum, kFloatRounding);
}

TEST(convert_paper, groups_at_or_below_the_opacity_threshold_are_dropped) {
    Leaf leaf;
    leaf.set(leaf_offset(0, 0, 0), 0.25f);
    leaf.set(leaf_offset(2, 2, 2), 0.5f);
    leaf.set(leaf_offset(4, 4, 4), 0);
    Volume volume = volume_of({leaf});
    volume.tiles = {{{64, 0, 0}, 8, 0.25f}, {{72, 0, 0}, 8, 0.375f}};
    const auto count = [&](float threshold) {
        PaperOptions options;
        options.opacity_threshold = threshold;
        return convert_paper(volume, options).size();
    };
    EXPECT_EQ(count(0), 4u);
    EXPECT_EQ(count(0.25f), 2u);
    EXPECT_EQ(count(0.5f), 0u);
}

TEST(convert_paper, leaves_without_density_give_nothing) {
    Leaf inactive, zero;
    zero.origin = {8, 0, 0};
    for (int n = 0; n < kLeafVoxels; ++n) zero.set(n, 0);
    const Volume volume = volume_of({inactive, zero});
    for (const Strategy strategy : kStrategies)
        EXPECT_EQ(convert_paper(volume, with(strategy)).size(), 0u) << strategy_name(strategy);
}

TEST(convert_paper, any_number_of_threads_gives_the_same_bytes) {
    const Volume volume = random_volume(11);
    for (const Strategy strategy : kStrategies) {
        const auto on = [&](int threads) {
            const ThreadLimit limit(threads);
            return convert_paper(volume, with(strategy));
        };
        const Gaussians one = on(1);
        for (const int threads : {2, 4}) {
            const Gaussians many = on(threads);
            EXPECT_EQ(one.mean, many.mean);
            EXPECT_EQ(one.scale, many.scale);
            EXPECT_EQ(one.density, many.density);
        }
    }
}

TEST(convert_paper, the_model_says_where_it_comes_from) {
    const Volume volume = random_volume(5);
    PaperOptions options = paper_lod(2);
    options.amplitude = Amplitude::mass;
    double done = 0;
    options.progress = [&done](double fraction) {
        EXPECT_GE(fraction, done);
        done = fraction;
    };
    const Gaussians model = convert_paper(volume, options);
    EXPECT_EQ(done, 1);
    EXPECT_EQ(model.source, "random.vdb density");
    EXPECT_EQ(model.method, "paper");
    EXPECT_EQ(model.options,
              "--set strategy=smart --set dense-block=4 --set amplitude=mass --set kappa=0.01 "
              "--set opacity-threshold=0.0001 --set minimum-radius=0.1");
    EXPECT_EQ(model.source_voxels, active_voxels(volume));
    EXPECT_EQ(model.box, world_box(volume));
    // exp(-k^2 / 2) = kappa.
    EXPECT_NEAR(std::exp(-0.5 * model.cutoff * model.cutoff), 0.01, kFloatRounding);
}

TEST(convert_paper, options_out_of_range_and_unusable_volumes_throw) {
    Volume volume = random_volume(2);
    const auto refused = [&](auto change) {
        PaperOptions options;
        change(options);
        EXPECT_THROW((void)convert_paper(volume, options), Error);
    };
    refused([](PaperOptions& o) { o.dense_block = 3; });
    refused([](PaperOptions& o) { o.opacity_threshold = -1; });
    refused([](PaperOptions& o) { o.minimum_radius_voxels = NAN; });
    refused([](PaperOptions& o) { o.kappa = 0; });
    refused([](PaperOptions& o) { o.kappa = 1; });
    refused([](PaperOptions& o) { o.variance_threshold = -0.5f; });
    refused([](PaperOptions& o) { o.similarity = 1.5f; });
    refused([](PaperOptions& o) { o.tree_depth = 0; });
    EXPECT_THROW((void)convert_paper(Volume{}), Error);
    for (const float value : {NAN, -1.f, INFINITY}) {
        Volume broken = volume;
        broken.leaves[4].value[17] = value;
        EXPECT_THROW((void)convert_paper(broken), Error);
        broken = volume;
        broken.tiles[1].value = value;
        EXPECT_THROW((void)convert_paper(broken), Error);
    }
    volume.world_from_index.linear(2, 2) = 0;
    EXPECT_THROW((void)convert_paper(volume), Error);
    volume.world_from_index = {{}, {0, NAN, 0}};
    EXPECT_THROW((void)convert_paper(volume), Error);
}

TEST(convert_paper, counts_of_real_data_follow_from_the_text) {
    VOG_NEEDS_DATA("smoke.vdb");
    const Volume volume = read_vdb(test::data_dir() / "smoke.vdb");
    const auto count = [&](int lod, float threshold) {
        PaperOptions options = paper_lod(lod);
        options.opacity_threshold = threshold;
        return convert_paper(volume, options).size();
    };
    const auto dense = static_cast<std::size_t>(std::count_if(
        volume.leaves.begin(), volume.leaves.end(), [](const Leaf& leaf) { return leaf.dense(); }));
    std::size_t reference = dense;
    for (const Leaf& leaf : volume.leaves)
        if (!leaf.dense()) reference += reference_groups(leaf, true).size();

    // Before the threshold.
    EXPECT_EQ(count(5, 0), 3117u);
    EXPECT_EQ(count(3, 0), reference);
    EXPECT_EQ(count(1, 0), reference + dense * (64 - 1));
    EXPECT_EQ(count(2, 0), reference + dense * (8 - 1));
    // At the default threshold: 178 K, 158 K and 156 K.
    const float threshold = PaperOptions{}.opacity_threshold;
    EXPECT_EQ(count(1, threshold), 178446u);
    EXPECT_EQ(count(2, threshold), 158679u);
    EXPECT_EQ(count(3, threshold), 156208u);

    for (int lod = 1; lod <= 5; ++lod) {
        PaperOptions options = paper_lod(lod);
        options.amplitude = Amplitude::mass;
        options.opacity_threshold = 0;
        EXPECT_NEAR(mass(convert_paper(volume, options)) / mass(volume), 1, kMassTolerance);
    }
}

}  // namespace
}  // namespace vog
