// hierarchy.cpp: the nodes' Gaussians, from the leaves up: moments, balls, errors; and checks.
#include "vog/hierarchy.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>
#include <span>

#include "convert/hierarchy_tree.h"
#include "convert/moment_sums.h"
#include "parallel.h"
#include "vog/error.h"

namespace vog {

namespace {

std::string name_of(const Gaussians& model) {
    return model.source.empty() ? "model" : model.source;
}

/// What a cut leaves of a kernel: mass of density 1 and scales 1, and share of the variance.
struct Kernel {
    double mass = 1, variance = 1;
};

/// Of one Gaussian, after the cut.
Moments moments_of(const Gaussians& model, std::size_t i, const Kernel& kernel) {
    const Vec3d s = vec_cast<double>(model.scale[i]);
    Moments moments{kernel.mass * model.density[i] * s.x * s.y * s.z,
                    vec_cast<double>(model.mean[i]), kernel_covariance(model, i)};
    for (double& c : moments.covariance) c *= kernel.variance;
    return moments;
}

/// Moments of a sum. Parts without any mass count alike: they still have a place.
Moments sum_of(std::span<const Moments> parts) {
    Moments sum;
    for (const Moments& part : parts) sum.mass += part.mass;
    const auto share = [&](const Moments& part) {
        return sum.mass > 0 ? part.mass / sum.mass : 1.0 / static_cast<double>(parts.size());
    };
    for (const Moments& part : parts) sum.mean = sum.mean + share(part) * part.mean;
    for (const Moments& part : parts) {
        const Vec3d d = part.mean - sum.mean;
        const std::array<double, 6> squares{d.x * d.x, d.x * d.y, d.x * d.z,
                                            d.y * d.y, d.y * d.z, d.z * d.z};
        for (std::size_t n = 0; n < 6; ++n)
            sum.covariance[n] += share(part) * (part.covariance[n] + squares[n]);
    }
    return sum;
}

/// What the nodes are made from.
struct Growth {
    const Gaussians& model;
    Hierarchy& tree;
    MomentFrame frame;
    Kernel kernel;
    std::vector<Moments> moments{};  ///< of the nodes
};

/// Radius of the ball around node n's mean that holds its own support and all below.
double radius_of(const Growth& growth, std::size_t n) {
    const Gaussians& model = growth.model;
    const Hierarchy& tree = growth.tree;
    const Vec3d center = vec_cast<double>(tree.nodes.mean[n]);
    const auto reach = [&](const Gaussians& of, std::size_t i) {
        const Vec3f s = of.scale[i];
        return of.cutoff * double{std::max({s.x, s.y, s.z})};
    };
    const auto distance = [&](Vec3f mean) { return length(vec_cast<double>(mean) - center); };
    double radius = reach(tree.nodes, n);
    const auto include_leaf = [&](std::size_t i) {
        radius = std::max(radius, distance(model.mean[i]) + reach(model, i));
    };
    const auto include_node = [&](std::size_t c) {
        radius = std::max(radius, distance(tree.nodes.mean[c]) + tree.radius[c]);
    };
    // Balls in balls grow with each level; small nodes can afford to ask every leaf.
    constexpr std::uint32_t kFew = 512;
    if (tree.count[n] > kFew) {
        for_each_child(tree, n, include_leaf, include_node);
    } else {
        for (std::uint32_t i = 0; i < tree.count[n]; ++i) include_leaf(tree.first[n] + i);
        for (std::uint32_t c = static_cast<std::uint32_t>(n) + 1; c < tree.end[n]; ++c)
            radius = std::max(radius, distance(tree.nodes.mean[c]) + reach(tree.nodes, c));
    }
    constexpr double kRounding = 1e-6;
    return radius * (1 + kRounding);
}

/// Makes node n from its children, nodes among them made before.
void make_node(Growth& growth, std::size_t n) {
    Hierarchy& tree = growth.tree;
    Moments parts[kMostChildren];
    std::size_t count = 0;
    // A child that is no smaller than the cell, as where several share a place, is what is lost.
    double error = tree.error[n], largest_variance = 0;
    const auto include = [&](const Moments& part) {
        parts[count++] = part;
        for (const std::size_t axis : {0, 3, 5})
            largest_variance = std::max(largest_variance, part.covariance[axis]);
    };
    for_each_child(
        tree, n, [&](std::size_t i) { include(moments_of(growth.model, i, growth.kernel)); },
        [&](std::size_t child) {
            include(growth.moments[child]);
            error = std::max(error, double{tree.error[child]});
        });
    growth.moments[n] = sum_of({parts, count});
    set_gaussian(tree.nodes, n, growth.moments[n], growth.frame);
    tree.error[n] =
        static_cast<float>(std::max(error, 0.5 * std::sqrt(largest_variance / kBoxVariance)));
    tree.radius[n] = static_cast<float>(radius_of(growth, n));
}

/// From the leaves up: subtrees side by side, then what is above them.
void make_nodes(Growth& growth) {
    Hierarchy& tree = growth.tree;
    constexpr std::uint32_t kWhole = 1 << 15;  // leaves of a task
    std::vector<std::size_t> above, subtrees;
    for (std::size_t n = 0; n < tree.size();) {
        const bool whole = tree.count[n] <= kWhole;
        (whole ? subtrees : above).push_back(n);
        n = whole ? tree.end[n] : n + 1;
    }
    vog::parallel_for(std::size_t{0}, subtrees.size(), [&](std::size_t task) {
        const std::size_t root = subtrees[task];
        for (std::size_t n = tree.end[root]; n-- > root;) make_node(growth, n);
    });
    for (const std::size_t n : above | std::views::reverse) make_node(growth, n);
}

}  // namespace

Hierarchy build_hierarchy(Gaussians& model, const HierarchyOptions& options) {
    validate(model);
    if (model.size() >= std::numeric_limits<std::uint32_t>::max())
        throw Error(fmt::format("{}: {} Gaussians, expected fewer than 2^32 in a hierarchy",
                                name_of(model), model.size()));
    Hierarchy tree = hierarchy_tree(model, options);
    link(tree, model.size(), name_of(model));
    tree.nodes.cutoff = model.cutoff;
    resize(tree.nodes, tree.size(), model.axis_aligned());
    tree.radius.resize(tree.size());
    const MomentFrame frame = moment_frame(Affine{}, model.axis_aligned(), 1, model.cutoff);
    Growth growth{model, tree, frame, {1 / frame.density_factor, 1 / frame.widening2}};
    growth.moments.resize(tree.size());
    make_nodes(growth);
    return tree;
}

void link(Hierarchy& hierarchy, std::size_t leaves, const std::string& where) {
    const std::size_t count = hierarchy.size();
    hierarchy.end.resize(count);
    // Nodes on the way from a root to this one.
    std::vector<std::uint32_t> open;
    const auto last = [&](std::size_t n) {
        return std::uint64_t{hierarchy.first[n]} + hierarchy.count[n];
    };
    const auto fail = [&](std::size_t n, const std::string& expected) {
        throw Error(
            fmt::format("{}: node {} of the hierarchy is of {} Gaussians from {}: expected {}",
                        where, n, hierarchy.count[n], hierarchy.first[n], expected));
    };
    std::uint64_t free = 0;  // leaves before this are another node's
    for (std::size_t n = 0; n < count; ++n) {
        if (hierarchy.count[n] < 2 || last(n) > leaves)
            fail(n, fmt::format("2 or more of the model's {}", leaves));
        while (!open.empty() && last(open.back()) <= hierarchy.first[n]) {
            free = last(open.back());
            hierarchy.end[open.back()] = static_cast<std::uint32_t>(n);
            open.pop_back();
        }
        if (!open.empty() && last(n) > last(open.back()))
            fail(n, fmt::format("within those of node {}", open.back()));
        if (hierarchy.first[n] < (open.empty() ? free : hierarchy.first[open.back()]))
            fail(n, "after those of the node before");
        open.push_back(static_cast<std::uint32_t>(n));
    }
    for (const std::uint32_t n : open) hierarchy.end[n] = static_cast<std::uint32_t>(count);
}

void validate(const Hierarchy& hierarchy, std::size_t leaves, double cutoff,
              const std::string& where) {
    const std::size_t count = hierarchy.size();
    const auto fail = [&](const std::string& what) {
        throw Error(fmt::format("{}: {}", where, what));
    };
    if (hierarchy.nodes.size() != count || hierarchy.count.size() != count ||
        hierarchy.end.size() != count || hierarchy.radius.size() != count ||
        hierarchy.error.size() != count)
        fail(fmt::format("a hierarchy of {} nodes with arrays of other lengths", count));
    if (count == 0) return;
    Hierarchy linked{{}, hierarchy.first, hierarchy.count, {}, {}, {}};
    link(linked, leaves, where);
    if (linked.end != hierarchy.end) fail("a hierarchy whose ends do not fit its nodes");
    if (double{hierarchy.nodes.cutoff} != cutoff)
        fail(fmt::format("a hierarchy with a cutoff of {}, expected the model's {}",
                         hierarchy.nodes.cutoff, cutoff));
    try {
        validate(hierarchy.nodes);
    } catch (const Error& error) {
        fail(fmt::format("nodes of the hierarchy: {}", error.what()));
    }
    for (std::size_t n = 0; n < count; ++n)
        for (const float length : {hierarchy.radius[n], hierarchy.error[n]})
            if (!(length >= 0) || !std::isfinite(length))
                fail(
                    fmt::format("node {} of the hierarchy: radius {}, error {}, expected finite "
                                "and >= 0",
                                n, hierarchy.radius[n], hierarchy.error[n]));
}

void append(Hierarchy& hierarchy, const Hierarchy& other, std::size_t leaves) {
    if (other.empty()) return;
    const std::size_t nodes = hierarchy.size();
    append(hierarchy.nodes, other.nodes);
    const auto join = [](auto& to, const auto& from, std::size_t shift) {
        for (const std::uint32_t value : from)
            to.push_back(static_cast<std::uint32_t>(value + shift));
    };
    join(hierarchy.first, other.first, leaves);
    join(hierarchy.count, other.count, 0);
    join(hierarchy.end, other.end, nodes);
    hierarchy.radius.insert(hierarchy.radius.end(), other.radius.begin(), other.radius.end());
    hierarchy.error.insert(hierarchy.error.end(), other.error.begin(), other.error.end());
}

}  // namespace vog
