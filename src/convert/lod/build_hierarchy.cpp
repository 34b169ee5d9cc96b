// build_hierarchy.cpp: Gaussian, bounding ball and geometric error of each node, bottom up.
#include "vog/lod.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "convert/lod/field_moments.h"
#include "convert/lod/mean_octree.h"
#include "convert/moments/gaussian_moments.h"
#include "core/parallel.h"
#include "data/fields/field_arrays.h"
#include "data/fields/field_limits.h"
#include "data/hierarchy_links.h"
#include "vog/error.h"

namespace vog {

using namespace lod;
using namespace moments;

namespace {

std::string name_of(const Gaussians& model) {
    return model.source.empty() ? "model" : model.source;
}

/// Truncated kernel of unit density and scales: its mass, and variance over that before truncation.
struct Kernel {
    double mass = 1, variance = 1;
};

/// Moments of Gaussian i after truncation.
Moments moments_of(const Gaussians& model, std::size_t i, const Kernel& kernel) {
    const Vec3d s = vec_cast<double>(model.scale[i]);
    Moments moments{kernel.mass * model.density[i] * s.x * s.y * s.z,
                    vec_cast<double>(model.mean[i]), kernel_covariance(model, i)};
    for (double& c : moments.covariance) c *= kernel.variance;
    return moments;
}

/// Moments of a sum of distributions. If none has mass, the mean is that of their means.
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

/// State of the construction.
struct Growth {
    const Gaussians& model;
    Hierarchy& tree;
    MomentFrame frame;
    Kernel kernel;
    std::vector<Moments> moments{};  ///< one for each node
    /// [fields][nodes]
    std::vector<BigVector<ScalarMoments>> scalar{};
    std::vector<BigVector<VectorMoments>> vector{};
};

/// Merges one field of node n's children.
/// of_nodes  moments of the field, complete for the nodes below
template <class Field, class FieldMoments>
void make_field(const Growth& growth, std::size_t n, const Merger& merger, const Field& of_leaves,
                Field& field, BigVector<FieldMoments>& of_nodes) {
    const Hierarchy& tree = growth.tree;
    std::array<FieldMoments, kMostChildren> parts;
    std::size_t count = 0;
    for (std::size_t k = 0; k < tree.leaf_count[n]; ++k, ++count)
        parts[count] =
            field_moments(of_leaves, tree.first_leaf[n] + k, merger.parts[count].covariance);
    for (std::size_t k = 0; k < tree.node_count[n]; ++k, ++count)
        parts[count] = of_nodes[tree.first_node[n] + k];
    of_nodes[n] = merged(merger, std::span<const FieldMoments>(parts.data(), count));
    set_field(field, n, of_nodes[n]);
}

void make_fields(Growth& growth, std::size_t n, const Merger& merger) {
    const Fields& leaves = growth.model.fields;
    Fields& nodes = growth.tree.nodes.fields;
    for (std::size_t k = 0; k < leaves.scalar.size(); ++k)
        make_field(growth, n, merger, leaves.scalar[k], nodes.scalar[k], growth.scalar[k]);
    for (std::size_t k = 0; k < leaves.vector.size(); ++k)
        make_field(growth, n, merger, leaves.vector[k], nodes.vector[k], growth.vector[k]);
}

/// Radius of the ball around node n's mean that contains its support and those of all below.
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
    // Balls around balls would grow with each level. Down to the first level with more than kFew
    // nodes the supports themselves are enclosed: the nodes and leaves below a node are contiguous
    // in each level.
    constexpr std::size_t kFew = 64;  // nodes of one level
    for (std::size_t first = n, last = n + 1; first < last;) {
        const std::size_t end = last - 1;
        for (std::size_t i = tree.first_leaf[first];
             i < tree.first_leaf[end] + tree.leaf_count[end]; ++i)
            radius = std::max(radius, distance(model.mean[i]) + reach(model, i));
        const std::size_t below = tree.first_node[first];
        const std::size_t below_last = tree.first_node[end] + tree.node_count[end];
        const bool few = below_last - below <= kFew;
        for (std::size_t c = below; c < below_last; ++c)
            radius = std::max(radius, distance(tree.nodes.mean[c]) +
                                          (few ? reach(tree.nodes, c) : double{tree.radius[c]}));
        if (!few) break;
        first = below;
        last = below_last;
    }
    constexpr double kRounding = 1e-6;
    return radius * (1 + kRounding);
}

/// Sets node n from its children, of which the nodes are complete.
void make_node(Growth& growth, std::size_t n) {
    Hierarchy& tree = growth.tree;
    Moments parts[kMostChildren];
    std::size_t count = 0;
    // The error is at least half the edge of the box with the variance of the widest child, which
    // may exceed the cell, as where several Gaussians share a place.
    double error = tree.error[n], largest_variance = 0;
    const auto include = [&](const Moments& part) {
        parts[count++] = part;
        for (const std::size_t axis : {0, 3, 5})
            largest_variance = std::max(largest_variance, part.covariance[axis]);
    };
    for (std::size_t k = 0; k < tree.leaf_count[n]; ++k)
        include(moments_of(growth.model, tree.first_leaf[n] + k, growth.kernel));
    for (std::size_t k = 0; k < tree.node_count[n]; ++k) {
        const std::size_t child = tree.first_node[n] + k;
        include(growth.moments[child]);
        error = std::max(error, double{tree.error[child]});
    }
    growth.moments[n] = sum_of({parts, count});
    set_gaussian(tree.nodes, n, growth.moments[n], growth.frame);
    if (!growth.model.fields.empty()) make_fields(growth, n, {growth.moments[n], {parts, count}});
    tree.error[n] =
        static_cast<float>(std::max(error, 0.5 * std::sqrt(largest_variance / kBoxVariance)));
    tree.radius[n] = static_cast<float>(radius_of(growth, n));
}

}  // namespace

Hierarchy build_hierarchy(Gaussians& model, const HierarchyOptions& options) {
    validate(model);
    if (model.size() >= std::numeric_limits<std::uint32_t>::max())
        throw Error(fmt::format("{}: {} Gaussians, expected fewer than 2^32 in a hierarchy",
                                name_of(model), model.size()));
    auto [tree, levels] = mean_octree(model, options);
    link(tree, model.size(), name_of(model));
    tree.nodes.cutoff = model.cutoff;
    tree.nodes.origin = model.origin;
    if (!tree.empty()) tree.nodes.fields = empty_fields(model.fields);
    resize(tree.nodes, tree.size(), model.axis_aligned());
    tree.radius.resize(tree.size());
    const MomentFrame frame = moment_frame(Affine{}, model.axis_aligned(), 1, model.cutoff);
    Growth growth{model, tree, frame, {1 / frame.density_factor, 1 / frame.widening2}};
    growth.moments.resize(tree.size());
    growth.scalar.resize(model.fields.scalar.size());
    growth.vector.resize(model.fields.vector.size());
    for (auto& field : growth.scalar) field.resize(tree.size());
    for (auto& field : growth.vector) field.resize(tree.size());
    // Level by level, from the leaves up.
    constexpr std::size_t kGrain = 256;
    for (std::size_t level = levels.size() - 1; level-- > 0;)
        vog::parallel_for(tbb::blocked_range<std::size_t>(levels[level], levels[level + 1], kGrain),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t n = range.begin(); n < range.end(); ++n)
                                  make_node(growth, n);
                          });
    limit_planes(tree.nodes);
    return std::move(tree);
}

}  // namespace vog
