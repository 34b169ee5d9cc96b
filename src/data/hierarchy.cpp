// hierarchy.cpp: child indices, validation and joining of hierarchies.
#include "vog/lod.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <cmath>
#include <vector>

#include "data/fields/field_arrays.h"
#include "data/hierarchy_links.h"
#include "vog/error.h"

namespace vog {

namespace {

/// Number of roots of a hierarchy in the order of link().
std::size_t root_count(const Hierarchy& hierarchy) {
    std::size_t below = 0;
    for (const std::uint8_t count : hierarchy.node_count) below += count;
    return below < hierarchy.size() ? hierarchy.size() - below : 0;
}

/// Checks that the hierarchy is a forest: every node and leaf is the child of at most one node, and
/// children follow their parents.
/// throws vog::Error naming `where` otherwise
void check_children(const Hierarchy& hierarchy, std::size_t leaves, const std::string& where) {
    std::vector<bool> node_has_parent(hierarchy.size()), leaf_has_parent(leaves);
    const auto mark = [](std::vector<bool>& has_parent, std::size_t first, std::size_t count) {
        if (first > has_parent.size() || count > has_parent.size() - first) return false;
        for (std::size_t i = first; i < first + count; ++i) {
            if (has_parent[i]) return false;
            has_parent[i] = true;
        }
        return true;
    };
    for (std::size_t n = 0; n < hierarchy.size(); ++n) {
        const std::size_t nodes = hierarchy.node_count[n], own = hierarchy.leaf_count[n];
        const auto fail = [&](const std::string& expected) {
            throw Error(fmt::format(
                "{}: node {} of the hierarchy has {} nodes from {} and {} Gaussians from {}: "
                "expected {}",
                where, n, nodes, hierarchy.first_node[n], own, hierarchy.first_leaf[n], expected));
        };
        if (nodes + own < 2) fail("2 or more in all");
        if (nodes > 0 && hierarchy.first_node[n] <= n) fail("nodes behind it");
        if (!mark(node_has_parent, nodes ? hierarchy.first_node[n] : 0, nodes))
            fail(fmt::format("nodes of the {} that have no other parent", hierarchy.size()));
        if (!mark(leaf_has_parent, own ? hierarchy.first_leaf[n] : 0, own))
            fail(fmt::format("Gaussians of the model's {} that have no other parent", leaves));
    }
}

std::string text(Vec3d v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }

}  // namespace

void link(Hierarchy& hierarchy, std::size_t leaves, const std::string& where) {
    const std::size_t count = hierarchy.size();
    hierarchy.first_node.resize(count);
    hierarchy.first_leaf.resize(count);
    std::uint64_t node = root_count(hierarchy), leaf = 0;
    for (std::size_t n = 0; n < count; ++n) {
        // Indices beyond 2^32 wrap around; check_children refuses such counts below.
        hierarchy.first_node[n] = static_cast<std::uint32_t>(node);
        hierarchy.first_leaf[n] = static_cast<std::uint32_t>(leaf);
        node += hierarchy.node_count[n];
        leaf += hierarchy.leaf_count[n];
    }
    check_children(hierarchy, leaves, where);
}

bool in_one_order(const Hierarchy& hierarchy) {
    std::size_t node = root_count(hierarchy), leaf = 0;
    for (std::size_t n = 0; n < hierarchy.size(); ++n) {
        if (hierarchy.first_node[n] != node || hierarchy.first_leaf[n] != leaf) return false;
        node += hierarchy.node_count[n];
        leaf += hierarchy.leaf_count[n];
    }
    return true;
}

void validate(const Hierarchy& hierarchy, const Gaussians& model, const std::string& where) {
    const std::size_t count = hierarchy.size();
    const auto fail = [&](const std::string& what) {
        throw Error(fmt::format("{}: {}", where, what));
    };
    if (hierarchy.nodes.size() != count || hierarchy.first_node.size() != count ||
        hierarchy.first_leaf.size() != count || hierarchy.leaf_count.size() != count ||
        hierarchy.radius.size() != count || hierarchy.error.size() != count)
        fail(fmt::format("hierarchy of {} nodes: arrays of different lengths", count));
    if (count == 0) return;
    check_children(hierarchy, model.size(), where);
    if (hierarchy.nodes.cutoff != model.cutoff)
        fail(fmt::format("hierarchy: cutoff {}, expected the model's {}", hierarchy.nodes.cutoff,
                         model.cutoff));
    if (hierarchy.nodes.origin != model.origin)
        fail(fmt::format("hierarchy: origin {}, expected the model's {}",
                         text(hierarchy.nodes.origin), text(model.origin)));
    if (!same_fields(hierarchy.nodes.fields, model.fields))
        fail(fmt::format("hierarchy: fields {}, expected the model's: {}",
                         fmt::join(hierarchy.nodes.fields.names(), ", "),
                         fmt::join(model.fields.names(), ", ")));
    try {
        validate(hierarchy.nodes);
    } catch (const Error& error) {
        fail(fmt::format("nodes of the hierarchy: {}", error.what()));
    }
    for (std::size_t n = 0; n < count; ++n)
        for (const float length : {hierarchy.radius[n], hierarchy.error[n]})
            if (!(length >= 0) || !std::isfinite(length))
                fail(fmt::format(
                    "node {} of the hierarchy: radius {}, error {}, expected finite and >= 0", n,
                    hierarchy.radius[n], hierarchy.error[n]));
}

void append(Hierarchy& hierarchy, const Hierarchy& other, std::size_t leaves) {
    if (other.empty()) return;
    const std::size_t nodes = hierarchy.size();
    append(hierarchy.nodes, other.nodes);
    const auto join = []<class T>(std::vector<T>& to, const std::vector<T>& from,
                                  std::size_t shift) {
        for (const T value : from) to.push_back(static_cast<T>(value + static_cast<T>(shift)));
    };
    join(hierarchy.first_node, other.first_node, nodes);
    join(hierarchy.first_leaf, other.first_leaf, leaves);
    join(hierarchy.node_count, other.node_count, 0);
    join(hierarchy.leaf_count, other.leaf_count, 0);
    join(hierarchy.radius, other.radius, 0);
    join(hierarchy.error, other.error, 0);
}

}  // namespace vog
