// view_cut_test.cpp: Cuts through a hierarchy: complete, coarser where nodes are small on screen, and
// without Gaussians outside the view.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/splat/splat.h"
#include "support/allocations.h"
#include "support/field_models.h"
#include "support/scenes.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/progress.h"
#include "vog/sample.h"

namespace vog::test {

namespace {

struct Tree {
    Gaussians model;
    Hierarchy hierarchy;
};
Tree tree_of(Gaussians model, const HierarchyOptions& options = {}) {
    Tree tree{std::move(model), {}};
    tree.hierarchy = build_hierarchy(tree.model, options);
    return tree;
}

Tree cloud_tree(int size, int block) {
    const Volume volume = sample_cloud({.size = size});
    MomentOptions options;
    options.block_voxels = block;
    return tree_of(convert_moments(volume, options), {inverse(volume.world_from_index)});
}

DepthImage draw(const Tree& tree, const Camera& camera, int width, int height,
                const CutOptions& cut, CutReport* report = nullptr) {
    SplatOptions options;
    options.hierarchy = &tree.hierarchy;
    options.cut = cut;
    SplatRenderer renderer(tree.model, options);
    DepthImage image = renderer.render(camera, width, height);
    if (report) *report = renderer.cut_report();
    return image;
}

/// From outside, beside, above and within, narrow and wide, looking at and away.
std::vector<Camera> cameras() {
    std::vector<Camera> all = {paper_view({{-1, -1, -1}, {1, 1, 1}})};
    Random random(77);
    for (int n = 0; n < 40; ++n) {
        Camera camera;
        camera.eye = random.in_cube(n % 2 ? 1.0 : 4.0);
        camera.look_at = random.in_cube(n % 3 ? 1.0 : 6.0);
        camera.fov_degrees = n % 4 == 0 ? 2 : n % 4 == 1 ? 165 : 50;
        all.push_back(camera);
    }
    return all;
}

double relative_l2(const DepthImage& reference, const DepthImage& image) {
    double error = 0, norm = 0;
    for (std::size_t n = 0; n < image.depth.size(); ++n) {
        error += std::pow(double{image.depth[n]} - reference.depth[n], 2);
        norm += std::pow(double{reference.depth[n]}, 2);
    }
    return std::sqrt(error / norm);
}

}  // namespace

TEST(view_cut, fields_come_along) {
    Gaussians model = random_gaussians(20000, 0.002, 0.05, 51);
    add_random_fields(model, 51);
    Tree tree = tree_of(std::move(model));
    // Values that tell whose they are.
    const auto mark = [](Gaussians& gaussians) {
        for (std::size_t i = 0; i < gaussians.size(); ++i) {
            gaussians.fields.scalar[1].skewness[i] = gaussians.mean[i].y;
            gaussians.fields.vector[0].gradient[2][i] = gaussians.mean[i];
        }
    };
    mark(tree.model);
    mark(tree.hierarchy.nodes);
    ViewCut cut(tree.model, tree.hierarchy);
    Camera camera = paper_view({{-1, -1, -1}, {1, 1, 1}});
    for (const int size : {20, 60}) {
        const Gaussians& chosen = cut.choose(frame_of(camera, size, size));
        ASSERT_GT(cut.report().nodes, 0u);
        ASSERT_NO_THROW(validate(chosen));
        EXPECT_EQ(chosen.fields.names(), tree.model.fields.names());
        for (std::size_t i = 0; i < chosen.size(); ++i) {
            ASSERT_EQ(chosen.fields.scalar[1].skewness[i], chosen.mean[i].y);
            ASSERT_EQ(chosen.fields.vector[0].gradient[2][i], chosen.mean[i]);
        }
    }
}

TEST(view_cut, at_no_error_it_is_the_model_byte_for_byte) {
    const Tree tree = tree_of(random_gaussians(30000, 0.002, 0.05, 51));
    const Camera camera = paper_view({{-1, -1, -1}, {1, 1, 1}});
    ViewCut cut(tree.model, tree.hierarchy);
    EXPECT_EQ(&cut.choose(frame_of(camera, 200, 200), {0, false}), &tree.model);
    EXPECT_EQ(&cut.choose(frame_of(camera, 200, 200), {0, true}), &tree.model);  // all in view
    for (const Camera& any : cameras())
        EXPECT_EQ(draw(tree, any, 120, 90, {0, true}).depth,
                  render_splat(tree.model, any, 120, 90).depth);
}

TEST(view_cut, skipped_nodes_never_change_a_pixel) {
    Gaussians model = random_gaussians(20000, 0.002, 0.03, 52);
    append(model, random_gaussians(60, 0.1, 0.8, 53));  // supports that reach far
    const Tree tree = tree_of(std::move(model));
    std::size_t left_out = 0;
    for (const double pixel_error : {0.0, 0.5, 3.0, 50.0})
        for (const Camera& camera : cameras()) {
            CutReport visible, all;
            const DepthImage image = draw(tree, camera, 64, 100, {pixel_error, true}, &visible);
            ASSERT_EQ(image.depth, draw(tree, camera, 64, 100, {pixel_error, false}, &all).depth);
            EXPECT_LE(visible.drawn(), all.drawn());
            EXPECT_LE(visible.visited, all.visited);
            left_out += visible.drawn() < all.drawn();
        }
    EXPECT_GT(left_out, cameras().size());
}

/// Leaves of one model lie between those of others, and some have no parent.
TEST(view_cut, joined_models_are_drawn_in_one_order) {
    Tree all = tree_of(random_gaussians(5000, 0.002, 0.05, 64));
    for (const std::uint64_t seed : {65, 66}) {
        const Tree other = tree_of(random_gaussians(5000, 0.002, 0.05, seed));
        append(all.hierarchy, other.hierarchy, all.model.size());
        append(all.model, other.model);
        append(all.model, random_gaussians(20, 0.01, 0.1, seed + 2));
    }
    validate(all.hierarchy, all.model, "joined");
    for (const Camera& camera : cameras()) {
        EXPECT_EQ(draw(all, camera, 60, 90, {0, true}).depth,
                  render_splat(all.model, camera, 60, 90).depth);
        EXPECT_EQ(draw(all, camera, 60, 90, {4, true}).depth,
                  draw(all, camera, 60, 90, {4, false}).depth);
    }
    ViewCut cut(all.model, all.hierarchy);
    for (const double pixel_error : {0.3, 5.0, 1e9})
        EXPECT_NEAR(mass(cut.choose(frame_of(cameras()[0], 50, 50), {pixel_error, false})) /
                        mass(all.model),
                    1, 1e-6);
}

TEST(view_cut, has_the_mass_of_the_model) {
    for (const std::uint64_t seed : {54, 55, 56}) {
        const Tree tree = tree_of(random_gaussians(5000, 1e-3, 0.1, seed));
        const double whole = mass(tree.model);
        ViewCut cut(tree.model, tree.hierarchy);
        for (const Camera& camera : cameras())
            for (const double pixel_error : {0.3, 2.0, 20.0, 1e9})
                // Every node's mass is rounded to a float.
                EXPECT_NEAR(
                    mass(cut.choose(frame_of(camera, 100, 100), {pixel_error, false})) / whole, 1,
                    1e-6);
    }
}

TEST(view_cut, merges_parts_below_a_pixel_and_no_others) {
    // Cells of one unit on a lattice, viewed along an axis, nearly without perspective.
    Gaussians model;
    for (int x = 0; x < 16; ++x)
        for (int y = 0; y < 16; ++y)
            for (int z = 0; z < 16; ++z)
                add(model, {float(x), float(y), float(z)}, {0.3f, 0.3f, 0.3f}, 1);
    const Tree tree = tree_of(std::move(model), {Affine{}});
    Camera camera;
    camera.eye = {7.5, 7.5, 1e4};
    camera.look_at = {7.5, 7.5, 7.5};
    camera.fov_degrees = 0.2;  // 34.9 units high
    const auto drawn = [&](int height) {
        CutReport report;
        draw(tree, camera, 16, height, {1, true}, &report);
        return report.drawn();
    };
    EXPECT_EQ(drawn(36), 4096u);  // a unit is 1.03 pixels
    EXPECT_EQ(drawn(34), 512u);   // 0.97 pixels
    EXPECT_EQ(drawn(17), 64u);
    EXPECT_EQ(drawn(8), 8u);
    EXPECT_EQ(drawn(4), 1u);
}

TEST(view_cut, t_comes_as_near_as_the_error_is_small) {
    const Tree tree = cloud_tree(64, 1);
    const Camera camera = paper_view(tree.model.box);
    const DepthImage full = render_splat(tree.model, camera, 256, 256);
    double before = 1;
    // Voxels are 2.5 pixels: below that hardly anything is merged.
    for (const auto& [pixel_error, bound] :
         {std::pair(16.0, 0.2), {8.0, 0.1}, {4.0, 0.05}, {3.0, 0.04}, {2.0, 1e-3}}) {
        const double error = relative_l2(full, draw(tree, camera, 256, 256, {pixel_error, true}));
        EXPECT_LE(error, bound) << pixel_error;
        EXPECT_LE(error, 1.01 * before) << pixel_error;  // two errors may make one cut
        before = error;
    }
}

TEST(view_cut, below_a_pixel_it_is_nearer_to_the_mean_over_the_pixel) {
    // Cells of a sixth of a pixel. The truth is the mean of T over a pixel, of 8 x 8 rays.
    const Tree tree = cloud_tree(128, 1);
    const Camera camera = paper_view(tree.model.box);
    constexpr int kSize = 32, kRays = 8;
    const DepthImage many = render_splat(tree.model, camera, kSize * kRays, kSize * kRays);
    DepthImage mean(kSize, kSize);
    for (int row = 0; row < many.height; ++row)
        for (int column = 0; column < many.width; ++column)
            mean.at(column / kRays, row / kRays) += many.at(column, row) / (kRays * kRays);
    CutReport report;
    const DepthImage cut = draw(tree, camera, kSize, kSize, {1, true}, &report);
    EXPECT_LT(report.drawn(), tree.model.size() / 50);
    EXPECT_LT(relative_l2(mean, cut),
              0.8 * relative_l2(mean, render_splat(tree.model, camera, kSize, kSize)));
}

TEST(view_cut, costs_what_is_visited_and_not_the_model) {
    const Tree tree = tree_of(random_gaussians(90000, 1e-3, 0.01, 57));
    Camera afar = paper_view({{-1, -1, -1}, {1, 1, 1}});
    afar.eye = 1e5 * afar.eye;
    CutReport report;
    draw(tree, afar, 100, 100, {1, true}, &report);
    EXPECT_EQ(report.visited, 1u);
    EXPECT_EQ(report.drawn(), 1u);
    Camera away = paper_view({{-1, -1, -1}, {1, 1, 1}});
    away.look_at = 2.0 * away.eye;
    draw(tree, away, 100, 100, {1, true}, &report);
    EXPECT_EQ(report.visited, 1u);
    EXPECT_EQ(report.drawn(), 0u);
    // A corner of it: a small part of the nodes.
    Camera corner = paper_view({{-1, -1, -1}, {1, 1, 1}});
    corner.fov_degrees = 2;
    draw(tree, corner, 1000, 1000, {0, true}, &report);
    EXPECT_LT(report.visited, tree.hierarchy.size() / 10);
    EXPECT_GT(report.leaves, 0u);
}

TEST(view_cut, the_eye_within_a_node_divides_it) {
    const Tree tree = tree_of(random_gaussians(2000, 0.01, 0.1, 58));
    Camera inside;
    inside.eye = {0, 0, 0};
    inside.look_at = {0, 0, 1};
    CutReport report;
    draw(tree, inside, 50, 50, {1e9, false}, &report);
    EXPECT_GT(report.drawn(), 5u);
}

TEST(view_cut, models_without_nodes_are_drawn_whole) {
    Gaussians one;
    add(one, {0, 0, 0}, {0.3f, 0.2f, 0.1f}, 1);
    for (const Gaussians& model : {Gaussians{}, one, random_gaussians(50, 0.1, 0.2, 59)}) {
        const Tree tree{model, {}};
        CutReport report;
        const Camera camera = paper_view({{-1, -1, -1}, {1, 1, 1}});
        EXPECT_EQ(draw(tree, camera, 40, 40, {1, true}, &report).depth,
                  render_splat(model, camera, 40, 40).depth);
        EXPECT_EQ(report.leaves, model.size());
    }
    Gaussians massless = random_gaussians(100, 0.1, 0.2, 60);
    for (float& density : massless.density) density = 0;
    const Tree tree = tree_of(massless);
    for (const float t :
         draw(tree, paper_view({{-1, -1, -1}, {1, 1, 1}}), 40, 40, {100, true}).depth)
        ASSERT_EQ(t, 0);
}

TEST(view_cut, is_the_same_for_any_number_of_threads) {
    const Tree tree = tree_of(random_gaussians(90000, 1e-3, 0.02, 61));
    const Camera camera = paper_view({{-1, -1, -1}, {1, 1, 1}});
    std::vector<DepthImage> images;
    for (const int threads : {1, 2, 8}) {
        const ThreadLimit limit(threads);
        images.push_back(draw(tree, camera, 150, 100, {2, true}));
    }
    EXPECT_EQ(images[0].depth, images[1].depth);
    EXPECT_EQ(images[0].depth, images[2].depth);
}

TEST(view_cut, a_frame_like_the_one_before_allocates_nothing) {
    if (allocations() < 0) GTEST_SKIP() << "the address sanitizer's operator new does not count";
    const Tree tree = tree_of(random_gaussians(60000, 1e-3, 0.02, 62));
    SplatOptions options;
    options.hierarchy = &tree.hierarchy;
    SplatRenderer renderer(tree.model, options);
    const Camera camera = paper_view({{-1, -1, -1}, {1, 1, 1}});
    DepthImage image;
    renderer.render(camera, 60, 40, image);
    const long before = allocations();
    for (int frame = 0; frame < 3; ++frame) renderer.render(camera, 60, 40, image);
    EXPECT_EQ(allocations() - before, 0);
}

TEST(view_cut, hierarchies_of_other_models_are_refused) {
    const Tree large = tree_of(random_gaussians(500, 0.1, 0.2, 67));
    const Tree small = tree_of(random_gaussians(20, 0.1, 0.2, 68));
    EXPECT_THROW(ViewCut(small.model, large.hierarchy), Error);
    SplatOptions options;
    options.hierarchy = &large.hierarchy;
    EXPECT_THROW(SplatRenderer(small.model, options), Error);
    Gaussians far = large.model;
    far.origin = {1e9, 0, 0};
    EXPECT_THROW(ViewCut(far, large.hierarchy), Error);
    Hierarchy cut_short = large.hierarchy;
    cut_short.leaf_count.pop_back();
    EXPECT_THROW(ViewCut(large.model, cut_short), Error);
    cut_short = large.hierarchy;
    cut_short.nodes.mean.pop_back();
    EXPECT_THROW(ViewCut(large.model, cut_short), Error);
}

TEST(view_cut, kernels_cut_further_out_are_not_left_out) {
    // At kappa 1e-9, k = 6.4: supports are three times as wide as the hierarchy's balls hold.
    Gaussians model = random_gaussians(5000, 0.002, 0.03, 69);
    const Tree tree = tree_of(std::move(model));
    for (const Camera& camera : cameras()) {
        SplatOptions cut, whole;
        cut.kappa = whole.kappa = 1e-9;
        cut.hierarchy = &tree.hierarchy;
        cut.cut = {0, true};
        EXPECT_EQ(render_splat(tree.model, camera, 60, 90, cut).depth,
                  render_splat(tree.model, camera, 60, 90, whole).depth);
    }
}

TEST(view_cut, invalid_options_throw) {
    const Tree tree = tree_of(random_gaussians(20, 0.1, 0.2, 63));
    const Camera camera = paper_view({{-1, -1, -1}, {1, 1, 1}});
    for (const double wrong : {-1.0, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THROW(draw(tree, camera, 10, 10, {wrong, true}), Error);
    SplatOptions options;
    options.hierarchy = &tree.hierarchy;
    options.aabb_sigma = 2;
    EXPECT_THROW(SplatRenderer(tree.model, options), Error);
}

}  // namespace vog::test
