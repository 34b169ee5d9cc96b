// build_hierarchy_test.cpp: moments, balls and order of nodes; refusal of invalid hierarchies.
#include "vog/lod.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "data/hierarchy_links.h"
#include "support/scenes.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/progress.h"
#include "vog/sample.h"

namespace vog::test {

namespace {

/// Mass, mass times mean and second moments about the origin, of Gaussians after truncation.
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

/// Leaves and nodes below node n.
struct Below {
    std::vector<std::size_t> leaves, nodes;
};
Below below(const Hierarchy& tree, std::size_t n) {
    Below all;
    std::vector<std::size_t> open{n};
    while (!open.empty()) {
        const std::size_t at = open.back();
        open.pop_back();
        for (std::size_t k = 0; k < tree.leaf_count[at]; ++k)
            all.leaves.push_back(tree.first_leaf[at] + k);
        for (std::size_t k = 0; k < tree.node_count[at]; ++k) {
            all.nodes.push_back(tree.first_node[at] + k);
            open.push_back(all.nodes.back());
        }
    }
    return all;
}

/// Every node has the moments of its leaves; without off-diagonals if the model is axis-aligned.
void expect_moments_of_leaves(const Gaussians& model, const Hierarchy& tree) {
    double extent = 0;
    for (std::size_t i = 0; i < model.size(); ++i)
        extent = std::max(extent,
                          support_box(model, i).radius() + length(vec_cast<double>(model.mean[i])));
    for (std::size_t n = 0; n < tree.size(); ++n) {
        Sums node, leaves;
        node.add(tree.nodes, n);
        for (const std::size_t i : below(tree, n).leaves) leaves.add(model, i);
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

/// The ball of a node contains all supports below; its error is at least those below.
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
        const Below all = below(tree, n);
        for (const std::size_t i : all.leaves) EXPECT_TRUE(holds(model, i)) << n;
        for (const std::size_t node : all.nodes) {
            EXPECT_TRUE(holds(tree.nodes, node)) << n;
            EXPECT_GE(tree.error[n], tree.error[node]);
        }
    }
}

/// Every leaf belongs to one node, nodes have 2 to 8 children, and the order is breadth-first.
void expect_a_tree(const Gaussians& model, const Hierarchy& tree) {
    validate(tree, model, "tree");
    EXPECT_TRUE(in_one_order(tree));
    ASSERT_GT(tree.size(), 0u);
    std::size_t node = 1, leaf = 0;  // the root is the first
    for (std::size_t n = 0; n < tree.size(); ++n) {
        EXPECT_EQ(tree.first_node[n], node);
        EXPECT_EQ(tree.first_leaf[n], leaf);
        node += tree.node_count[n];
        leaf += tree.leaf_count[n];
        EXPECT_GE(tree.node_count[n] + tree.leaf_count[n], 2);
        EXPECT_LE(tree.node_count[n] + tree.leaf_count[n], 8);
    }
    EXPECT_EQ(node, tree.size());
    EXPECT_EQ(leaf, model.size());
}

}  // namespace

TEST(hierarchy, nodes_have_the_moments_of_their_leaves_for_random_models) {
    for (const int count : {2, 3, 9, 100, 3000})
        for (const float cutoff : {1.0f, 2.25f, 4.0f}) {
            Gaussians model = random_gaussians(count, 1e-3, 0.5, 70 + count, cutoff);
            if (count == 9) model.rotation.clear();
            const double before = mass(model);
            const Hierarchy tree = build_hierarchy(model);
            EXPECT_NEAR(mass(model), before, 1e-12 * before);  // reordered only
            expect_a_tree(model, tree);
            expect_moments_of_leaves(model, tree);
            expect_balls_that_hold(model, tree);
        }
}

TEST(hierarchy, large_models_are_trees_too) {
    // Levels with more nodes than a parallel task has.
    Gaussians model = random_gaussians(90000, 1e-3, 0.01, 5);
    const Hierarchy tree = build_hierarchy(model);
    expect_a_tree(model, tree);
    for (const std::size_t n : {std::size_t{0}, tree.size() / 3, tree.size() - 1}) {
        double leaves = 0;
        for (const std::size_t i : below(tree, n).leaves) leaves += mass(model, i);
        EXPECT_NEAR(mass(tree.nodes, n), leaves, kFloat * leaves);
    }
}

TEST(hierarchy, nodes_of_uniform_cells_are_the_next_uniform_cells) {
    const Volume volume = sample_cloud({.size = 64});
    MomentOptions options;
    options.mass_threshold = 0;
    options.soft_steps = 0;
    options.block_voxels = 2;
    Gaussians fine = convert_moments(volume, options);
    options.block_voxels = 4;
    const Gaussians coarse = convert_moments(volume, options);
    const Hierarchy tree = build_hierarchy(fine, {inverse(volume.world_from_index)});
    // Full cells of 4 voxels: eight leaves, half an edge of 2 voxels.
    const double half_edge = 2 * length(volume.world_from_index.linear.column(0));
    std::size_t full = 0, next = 0;
    for (std::size_t n = 0; n < tree.size(); ++n) {
        if (tree.leaf_count[n] != 8 || std::abs(tree.error[n] - half_edge) > 1e-5 * half_edge)
            continue;
        const auto at = [&](std::size_t c) {
            return length(vec_cast<double>(coarse.mean[c]) - vec_cast<double>(tree.nodes.mean[n]));
        };
        // Both are in Morton order; that of the nodes starts again with every level.
        for (std::size_t tried = 0; tried < coarse.size() && at(next) > 1e-5; ++tried)
            next = (next + 1) % coarse.size();
        ASSERT_LE(at(next), 1e-5) << "node " << n << " is none of the coarser cells";
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
    // Gaussians with equal means still have widths, which count as error.
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
    EXPECT_EQ(a.node_count, b.node_count);
    EXPECT_EQ(a.leaf_count, b.leaf_count);
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
    validate(tree, model, "joined");
    EXPECT_FALSE(in_one_order(tree));
    expect_moments_of_leaves(model, tree);
    expect_balls_that_hold(model, tree);
}

TEST(hierarchy, invalid_hierarchies_are_refused_by_their_first_wrong_node) {
    Gaussians model = random_gaussians(200, 0.01, 0.1, 30);
    const Hierarchy good = build_hierarchy(model);
    const auto error_of = [&](const auto& spoil) {
        Hierarchy tree = good;
        spoil(tree);
        try {
            link(tree, model.size(), "file");
            validate(tree, model, "file");
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
    const auto last = good.size() - 1;
    EXPECT_TRUE(
        contains(error_of([&](Hierarchy& t) { t.leaf_count[last] = 255; }), "the model's 200"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.node_count[0] = 255; }), "node 0"));
    EXPECT_TRUE(
        contains(error_of([&](Hierarchy& t) { t.node_count[last] = 0, t.leaf_count[last] = 1; }),
                 "2 or more"));
    EXPECT_TRUE(
        contains(error_of([&](Hierarchy& t) { t.leaf_count.assign(t.size(), 0); }), "2 or more"));
    // Links checked as they are, without link().
    const auto error_as_it_is = [&](const auto& spoil) {
        Hierarchy tree = good;
        spoil(tree);
        try {
            validate(tree, model, "memory");
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_TRUE(contains(error_as_it_is([](Hierarchy& t) { t.first_node[0] = 0; }), "behind it"));
    EXPECT_TRUE(contains(error_as_it_is([](Hierarchy& t) { t.first_node[2] = t.first_node[1]; }),
                         "no other parent"));
    EXPECT_TRUE(contains(error_as_it_is([&](Hierarchy& t) { t.first_leaf[last] = 0xffffffff; }),
                         "no other parent"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.radius[5] = -1; }), "node 5"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.error[5] = NAN; }), "node 5"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.nodes.scale[7].y = 0; }), "scales"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.radius.pop_back(); }), "lengths"));
    EXPECT_TRUE(contains(error_of([](Hierarchy& t) { t.nodes.cutoff = 3; }), "cutoff"));
}

}  // namespace vog::test
