// companion_clusters_test.cpp: counts and boxes of the companion paper's three clusterings.
#include <gtest/gtest.h>

#include <array>

#include "support/random_volume.h"
#include "vog/convert_paper.h"

namespace vog {
namespace {

using test::volume_of;

PaperOptions clusters_by(Strategy strategy) {
    PaperOptions options;
    options.strategy = strategy;
    options.opacity_threshold = 0;
    return options;
}

/// A dense leaf of the values value(x, y, z).
template <class Value>
Leaf leaf_of(Vec3i origin, const Value& value) {
    Leaf leaf;
    leaf.origin = origin;
    for (int n = 0; n < kLeafVoxels; ++n)
        leaf.set(n, static_cast<float>(value(n >> 6, (n >> 3) & 7, n & 7)));
    return leaf;
}

Leaf constant_leaf(Vec3i origin, double density) {
    return leaf_of(origin, [density](int, int, int) { return density; });
}

std::size_t variance_count(const Volume& volume, double threshold) {
    PaperOptions options = clusters_by(Strategy::variance_clusters);
    options.variance_threshold = static_cast<float>(threshold);
    return convert_paper(volume, options).size();
}

std::size_t neighbour_count(const Volume& volume, double similarity) {
    PaperOptions options = clusters_by(Strategy::leaf_clusters);
    options.similarity = static_cast<float>(similarity);
    return convert_paper(volume, options).size();
}

std::size_t tree_count(const Volume& volume, int depth) {
    PaperOptions options = clusters_by(Strategy::tree_mirror);
    options.tree_depth = depth;
    return convert_paper(volume, options).size();
}

TEST(convert_variance, a_uniform_leaf_is_one_cluster) {
    // 0.1 is not representable: its sums are rounded.
    EXPECT_EQ(variance_count(volume_of({constant_leaf({0, 0, 0}, 0.1)}), 0), 1u);
}

TEST(convert_variance, a_leaf_is_halved_down_to_where_values_differ) {
    const auto split_at = [](int x) {
        return volume_of({leaf_of({0, 0, 0}, [x](int i, int, int) { return i < x ? 1.0 : 3.0; })});
    };
    EXPECT_EQ(variance_count(split_at(4), 0), 8u);
    // A step at 2: the four octants below it split in eight, and so on down to voxels.
    EXPECT_EQ(variance_count(split_at(2), 0), 4u + 4 * 8u);
    EXPECT_EQ(variance_count(split_at(1), 0), 4u + 4 * (4u + 4 * 8u));
    // The volume's own variance is that of the whole leaf.
    EXPECT_EQ(variance_count(split_at(2), 1), 1u);
}

TEST(convert_variance, a_uniform_part_that_fills_its_box_is_one_cluster) {
    Leaf plate;
    for (int n = 0; n < 64; ++n) plate.set(leaf_offset(5, n >> 3, n & 7), 2);
    EXPECT_EQ(variance_count(volume_of({plate}), 0), 1u);
    // Two opposite corners: the zeros of their box count, so they are separated.
    Leaf corners;
    corners.set(leaf_offset(0, 0, 0), 2);
    corners.set(leaf_offset(7, 7, 7), 2);
    EXPECT_EQ(variance_count(volume_of({corners}), 0), 2u);
}

TEST(convert_variance, a_higher_threshold_never_gives_more_clusters) {
    const Volume volume = test::random_volume(4);
    std::size_t before = active_voxels(volume);
    for (const double threshold : {0.0, 0.001, 0.1, 1.0, 10.0}) {
        const std::size_t count = variance_count(volume, threshold);
        EXPECT_LE(count, before) << threshold;
        before = count;
    }
    // One a leaf with anything in it, and the tiles.
    EXPECT_EQ(before, 26u + 3u);
}

TEST(convert_neighbours, similar_leaves_join_and_others_do_not) {
    const Volume volume = volume_of({constant_leaf({0, 0, 0}, 1), constant_leaf({8, 0, 0}, 1.05),
                                     constant_leaf({16, 0, 0}, 2)});
    EXPECT_EQ(neighbour_count(volume, 0), 3u);
    EXPECT_EQ(neighbour_count(volume, 0.1), 2u);
    EXPECT_EQ(neighbour_count(volume, 1), 1u);
    const Gaussians joined = convert_paper(volume, clusters_by(Strategy::leaf_clusters));
    EXPECT_FLOAT_EQ(joined.mean[0].x, 7.5f);
    EXPECT_FLOAT_EQ(joined.scale[0].x, static_cast<float>(8 / std::sqrt(2.0)));
    EXPECT_FLOAT_EQ(joined.scale[0].y, static_cast<float>(4 / std::sqrt(2.0)));
    EXPECT_FLOAT_EQ(joined.density[0], 1.025f);
}

TEST(convert_neighbours, clusters_are_boxes_of_leaves_inside_one_lower_node) {
    // Three leaves in an L: two and one. Four in a square: one.
    BigVector<Leaf> leaves = {constant_leaf({0, 0, 0}, 1), constant_leaf({8, 0, 0}, 1),
                              constant_leaf({0, 8, 0}, 1)};
    EXPECT_EQ(neighbour_count(volume_of(leaves), 0), 2u);
    leaves.push_back(constant_leaf({8, 8, 0}, 1));
    EXPECT_EQ(neighbour_count(volume_of(leaves), 0), 1u);
    // Touching, in two lower nodes.
    const Volume across = volume_of({constant_leaf({120, 0, 0}, 1), constant_leaf({128, 0, 0}, 1),
                                     constant_leaf({-8, 0, 0}, 1), constant_leaf({0, 0, 0}, 1)});
    EXPECT_EQ(neighbour_count(across, 1), 4u);
    // A whole lower node, 16^3 leaves, is one.
    leaves.clear();
    for (int n = 0; n < 4096; ++n)
        leaves.push_back(constant_leaf({8 * (n >> 8), 8 * ((n >> 4) & 15), 8 * (n & 15)}, 1));
    EXPECT_EQ(neighbour_count(volume_of(leaves), 0), 1u);
}

TEST(convert_tree, leaves_at_depth_three_are_the_papers_level_five) {
    const Volume volume = test::random_volume(6);
    const Gaussians tree = convert_paper(volume, clusters_by(Strategy::tree_mirror));
    PaperOptions options = paper_lod(5);
    options.opacity_threshold = 0;
    const Gaussians paper = convert_paper(volume, options);
    EXPECT_EQ(tree.mean, paper.mean);
    EXPECT_EQ(tree.scale, paper.scale);
    EXPECT_EQ(tree.density, paper.density);
}

TEST(convert_tree, each_node_above_is_one_gaussian) {
    const Volume volume = test::random_volume(6);
    // 27 leaves around index 0 lie in 8 lower nodes and 8 children of the root. The tile of 8^3 at
    // (24, -8, 0) lies among them; that of 128^3 in a lower node's place, under one of the eight.
    EXPECT_EQ(tree_count(volume, 2), 8u + 2u);
    EXPECT_EQ(tree_count(volume, 1), 8u + 1u);
}

TEST(convert_tree, a_node_has_the_tight_box_and_the_mean_of_its_voxels) {
    Volume volume = volume_of({constant_leaf({0, 0, 0}, 1), constant_leaf({112, 0, 8}, 2)});
    volume.tiles = {{{64, 64, 64}, 8, 6}};
    PaperOptions options = clusters_by(Strategy::tree_mirror);
    options.tree_depth = 2;
    const Gaussians model = convert_paper(volume, options);
    ASSERT_EQ(model.size(), 1u);
    EXPECT_FLOAT_EQ(model.density[0], 3);
    EXPECT_EQ(model.mean[0], (Vec3f{59.5f, 35.5f, 35.5f}));
    EXPECT_FLOAT_EQ(model.scale[0].x, static_cast<float>(60 / std::sqrt(2.0)));
    EXPECT_FLOAT_EQ(model.scale[0].y, static_cast<float>(36 / std::sqrt(2.0)));
}

}  // namespace
}  // namespace vog
