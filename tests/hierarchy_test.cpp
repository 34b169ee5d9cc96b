// hierarchy_test.cpp: what a node stands for, in what order, and what is no hierarchy.
#include "vog/hierarchy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/scenes.h"
#include "vog/error.h"
#include "vog/moments.h"
#include "vog/progress.h"
#include "vog/sample.h"

namespace vog::test {

namespace {

/// Mass, mass times mean and second moments about the origin of Gaussian i, after the cut.
struct Sums {
    double mass = 0;
    Vec3d first;
    Mat3 second{{Vec3d{}, {}, {}}};

    void add(const Gaussians& model, std::size_t i) {
        const double m = vog::mass(model, i), share = variance_within(model.cutoff);
        const Vec3d at = vec_cast<double>(model.mean[i]), s = vec_cast<double>(model.scale[i]);
        const Mat3 r = model.axis_aligned() ? Mat3{} : matrix_from_quat(model.rotation[i]);
        mass += m;
        first = first + m * at;
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) {
                double covariance = 0;
                for (int k = 0; k < 3; ++k) covariance += share * r(a, k) * s[k] * s[k] * r(b, k);
                second(a, b) += m * (covariance + at[a] * at[b]);
            }
    }
};

// Scales, means and densities are float32: each is off by 6e-8 of itself, products of three or four
// of them, summed over a few thousand, by a few 1e-7 of the largest.
constexpr double kFloat = 2e-6;

/// Moments of every node are those of its leaves; of an axis-aligned model, but for off-diagonals.
void expect_moments_of_leaves(const Gaussians& model, const Hierarchy& tree) {
    double extent = 0;
    for (std::size_t i = 0; i < model.size(); ++i)
        extent = std::max(extent,
                          support_box(model, i).radius() + length(vec_cast<double>(model.mean[i])));
    for (std::size_t n = 0; n < tree.size(); ++n) {
        Sums node, leaves;
        node.add(tree.nodes, n);
        for (std::uint32_t i = 0; i < tree.count[n]; ++i) leaves.add(model, tree.first[n] + i);
        const double tolerance = kFloat * leaves.mass;
        ASSERT_NEAR(node.mass, leaves.mass, tolerance) << n;
        for (int a = 0; a < 3; ++a) {
            ASSERT_NEAR(node.first[a], leaves.first[a], tolerance * extent) << n;
            for (int b = 0; b < 3; ++b)
                if (a == b || !model.axis_aligned()) {
                    ASSERT_NEAR(node.second(a, b), leaves.second(a, b), tolerance * extent * extent)
                        << n;
                }
        }
    }
}

/// Everything below a node lies in its ball; every error is at least those below.
void expect_balls_that_hold(const Gaussians& model, const Hierarchy& tree) {
    const auto reach = [](const Gaussians& of, std::size_t i) {
        const Vec3f s = of.scale[i];
        return of.cutoff * double{std::max({s.x, s.y, s.z})};
    };
    for (std::size_t n = 0; n < tree.size(); ++n) {
        const Vec3d center = vec_cast<double>(tree.nodes.mean[n]);
        const auto holds = [&](const Gaussians& of, std::size_t i) {
            return length(vec_cast<double>(of.mean[i]) - center) + reach(of, i) <= tree.radius[n];
        };
        EXPECT_TRUE(holds(tree.nodes, n)) << n;
        for (std::uint32_t i = 0; i < tree.count[n]; ++i)
            EXPECT_TRUE(holds(model, tree.first[n] + i)) << n;
        for (std::size_t below = n + 1; below < tree.end[n]; ++below) {
            EXPECT_TRUE(holds(tree.nodes, below)) << n;
            EXPECT_GE(tree.error[n], tree.error[below]);
        }
    }
}

/// No leaf is lost, no node has a single child or too many.
void expect_a_tree(const Gaussians& model, const Hierarchy& tree) {
    validate(tree, model.size(), model.cutoff, "tree");
    ASSERT_GT(tree.size(), 0u);
    EXPECT_EQ(tree.first[0], 0u);
    EXPECT_EQ(tree.count[0], model.size());
    EXPECT_EQ(tree.end[0], tree.size());
    for (std::size_t n = 0; n < tree.size(); ++n) {
        std::size_t children = 0, next = tree.first[n];
        for_each_child(
            tree, n,
            [&](std::size_t i) {
                EXPECT_EQ(i, next++);
                ++children;
            },
            [&](std::size_t child) {
                EXPECT_EQ(tree.first[child], next);
                next += tree.count[child];
                ++children;
            });
        EXPECT_EQ(next, tree.first[n] + tree.count[n]);
        EXPECT_GE(children, 2u);
        EXPECT_LE(children, 8u);
    }
}

}  // namespace

TEST(hierarchy, nodes_have_the_moments_of_what_is_below_for_random_models) {
    for (const int count : {2, 3, 9, 100, 3000})
        for (const float cutoff : {1.0f, 2.25f, 4.0f}) {
            Gaussians model = random_gaussians(count, 1e-3, 0.5, 70 + count, cutoff);
            if (count == 9) model.rotation.clear();
            const double before = mass(model);
            const Hierarchy tree = build_hierarchy(model);
            EXPECT_NEAR(mass(model), before, 1e-12 * before);  // in another order only
            expect_a_tree(model, tree);
            expect_moments_of_leaves(model, tree);
            expect_balls_that_hold(model, tree);
        }
}

TEST(hierarchy, large_models_are_trees_too) {
    // Above the size of a task, where subtrees are built side by side.
    Gaussians model = random_gaussians(90000, 1e-3, 0.01, 5);
    const Hierarchy tree = build_hierarchy(model);
    expect_a_tree(model, tree);
    for (const std::size_t n : {std::size_t{0}, tree.size() / 3, tree.size() - 1}) {
        double below = 0;
        for (std::uint32_t i = 0; i < tree.count[n]; ++i) below += mass(model, tree.first[n] + i);
        EXPECT_NEAR(mass(tree.nodes, n), below, kFloat * below);
    }
}

TEST(hierarchy, nodes_of_uniform_cells_are_the_next_uniform_cells) {
    const Volume volume = sample_cloud({.size = 64});
    MomentOptions options;
    options.mass_threshold = 0;
    options.block_voxels = 2;
    Gaussians fine = convert_moments(volume, options);
    options.block_voxels = 4;
    const Gaussians coarse = convert_moments(volume, options);
    const BigVector<Vec3f> order = fine.mean;
    const Hierarchy tree = build_hierarchy(fine, {inverse(volume.world_from_index)});
    EXPECT_EQ(fine.mean, order);  // Morton order already
    // Full cells of 4 voxels: eight leaves, half an edge of 2 voxels.
    const double half_edge = 2 * length(volume.world_from_index.linear.column(0));
    std::size_t full = 0, next = 0;
    for (std::size_t n = 0; n < tree.size(); ++n) {
        if (tree.count[n] != 8 || std::abs(tree.error[n] - half_edge) > 1e-5 * half_edge) continue;
        const auto at = [&](std::size_t c) {
            return length(vec_cast<double>(coarse.mean[c]) - vec_cast<double>(tree.nodes.mean[n]));
        };
        while (next < coarse.size() && at(next) > 1e-5) ++next;
        ASSERT_LT(next, coarse.size()) << "node " << n << " is none of the coarser cells";
        EXPECT_NEAR(mass(tree.nodes, n), mass(coarse, next), 1e-5 * mass(coarse, next));
        ++full;
    }
    EXPECT_GT(full, coarse.size() / 2);
}

TEST(hierarchy, degenerate_models_have_one) {
    Gaussians none, one;
    EXPECT_TRUE(build_hierarchy(none).empty());
    add(one, {1, 2, 3}, {1, 1, 1}, 1);
    EXPECT_TRUE(build_hierarchy(one).empty());

    Gaussians together;
    for (int n = 0; n < 1000; ++n)
        add(together, {5, 5, 5}, {0.1f, 0.2f, 0.1f * float(n % 7 + 1)}, 1);
    const Hierarchy heap = build_hierarchy(together);
    expect_a_tree(together, heap);
    expect_moments_of_leaves(together, heap);
    // What has a width of its own is no point, though all means agree.
    EXPECT_GE(heap.error[0], 0.5 * 0.6);

    Gaussians massless = random_gaussians(100, 0.1, 0.2, 9);
    for (float& density : massless.density) density = 0;
    const Hierarchy empty = build_hierarchy(massless);
    expect_a_tree(massless, empty);
    for (const float density : empty.nodes.density) EXPECT_EQ(density, 0);

    Gaussians far = random_gaussians(50, 1e-4, 1e-3, 10);
    add(far, {1e30f, -1e30f, 1e30f}, {1, 1, 1}, 1);
    expect_a_tree(far, build_hierarchy(far));

    Gaussians row;  // a line along one axis: cells with two children
    for (int n = 0; n < 300; ++n) add(row, {float(n), 0, 0}, {0.3f, 0.3f, 0.3f}, 1);
    const Hierarchy line = build_hierarchy(row, {Affine{}});
    expect_a_tree(row, line);
    expect_moments_of_leaves(row, line);
}

TEST(hierarchy, is_the_same_for_any_number_of_threads) {
    const Gaussians model = random_gaussians(80000, 1e-3, 0.02, 12);
    const auto build = [](Gaussians& leaves, int threads) {
        const ThreadLimit limit(threads);
        return build_hierarchy(leaves);
    };
    Gaussians many = model, single = model;
    const Hierarchy a = build(many, 8), b = build(single, 1);
    EXPECT_EQ(many.mean, single.mean);
    EXPECT_EQ(a.first, b.first);
    EXPECT_EQ(a.count, b.count);
    EXPECT_EQ(a.end, b.end);
    EXPECT_EQ(a.nodes.mean, b.nodes.mean);
    EXPECT_EQ(a.nodes.scale, b.nodes.scale);
    EXPECT_EQ(a.nodes.rotation, b.nodes.rotation);
    EXPECT_EQ(a.nodes.density, b.nodes.density);
    EXPECT_EQ(a.radius, b.radius);
    EXPECT_EQ(a.error, b.error);
}

TEST(hierarchy, joined_models_have_joined_hierarchies) {
    Gaussians model = random_gaussians(500, 0.01, 0.1, 20),
              other = random_gaussians(300, 0.01, 0.1, 21);
    Hierarchy tree = build_hierarchy(model);
    append(tree, build_hierarchy(other), model.size());
    append(model, other);
    append(tree, Hierarchy{}, model.size());
    validate(tree, model.size(), model.cutoff, "joined");
    expect_moments_of_leaves(model, tree);
    expect_balls_that_hold(model, tree);
}

TEST(hierarchy, what_is_none_is_refused_by_its_first_wrong_node) {
    Gaussians model = random_gaussians(200, 0.01, 0.1, 30);
    const Hierarchy good = build_hierarchy(model);
    const auto error_of = [&](const auto& spoil) {
        Hierarchy tree = good;
        spoil(tree);
        try {
            link(tree, model.size(), "file");
            validate(tree, model.size(), model.cutoff, "file");
        } catch (const Error& error) {
            EXPECT_EQ(std::string(error.what()).rfind("file: ", 0), 0u) << error.what();
            return std::string(error.what());
        }
        return std::string("no error");
    };
    const auto contains = [](const std::string& text, const std::string& part) {
        return text.find(part) != std::string::npos;
    };
    EXPECT_EQ(error_of([](Hierarchy&) {}), "no error");
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.count[0] = 201; }), "node 0"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.first[3] = 0xffffffff; }), "node 3"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.count[3] = 1; }), "2 or more"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.count[3] = 0xffffffff; }), "node 3"));
    EXPECT_NE(error_of([](Hierarchy& t) { std::swap(t.first[2], t.first[t.size() - 1]); }),
              "no error");
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.radius[5] = -1; }), "node 5"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.error[5] = NAN; }), "node 5"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.nodes.scale[7].y = 0; }), "scales"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.radius.pop_back(); }), "lengths"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.nodes.cutoff = 3; }), "cutoff"));
}

}  // namespace vog::test
