// mean_octree.cpp: octree from sorted Morton codes of the means: every cell is a run of codes,
// divided by bisection, level by level.
#include "convert/lod/mean_octree.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>

#include "core/morton.h"
#include "core/parallel.h"
#include "data/fields/field_arrays.h"

namespace vog::lod {

namespace {

/// Morton code of a mean, and the index of its Gaussian.
struct Place {
    std::uint64_t code = 0;
    std::uint32_t index = 0;
    friend bool operator<(const Place& a, const Place& b) {
        return std::tie(a.code, a.index) < std::tie(b.code, b.index);
    }
};

/// Map from means to the lattice of the codes, coordinates in [0, 2^21).
Affine code_from_mean(const Gaussians& model, const HierarchyOptions& options) {
    constexpr double kSide = 1 << kMortonAxisBits;
    Box means;
    Affine lattice = options.index_from_world.value_or(Affine{});
    lattice.translation = options.index_from_world ? lattice(model.origin) : Vec3d{};
    for (const Vec3f& mean : model.mean) means.include(lattice(vec_cast<double>(mean)));
    const Vec3d edges = means.upper - means.lower;
    const double edge = std::max({edges.x, edges.y, edges.z});
    double scale = 1;
    Vec3d shift;
    if (options.index_from_world && edge < 0.25 * kSide) {
        // Cells of 2^n voxels begin at multiples of 2^n voxels. A shift by multiples of a large
        // power of two keeps the octree aligned with them.
        constexpr double kCoarsest = 0.25 * kSide, kVoxelEdge = 0.5;
        for (int axis = 0; axis < 3; ++axis)
            shift[axis] = kVoxelEdge - kCoarsest * std::floor(means.lower[axis] / kCoarsest);
    } else {
        scale = edge > 0 ? 0.999 * kSide / edge : 1;
        shift = -scale * means.lower;
    }
    const Mat3 larger{{Vec3d{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}}};
    return {larger * lattice.linear, scale * lattice.translation + shift};
}

/// Calls body(i) for all i below count, in parallel.
template <class Body>
void for_all(std::size_t count, const Body& body) {
    constexpr std::size_t kGrain = 4096;
    vog::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
                      });
}

/// Models of uniform conversions are in order already, but for Gaussians of windows whose mean lies outside their cell:
/// these alone are sorted, and merged with the others.
void sort_places(std::vector<Place>& places) {
    const std::size_t most = places.size() / 4;  // others; with more, sorting all is as fast
    std::vector<Place> others;
    std::size_t ordered = 0, i = 0;  // places before `ordered` ascend
    for (; i < places.size() && others.size() <= most; ++i) {
        if (ordered == 0 || !(places[i] < places[ordered - 1])) {
            places[ordered++] = places[i];
            continue;
        }
        // One of the two is out of place; both are taken out.
        others.push_back(places[i]);
        others.push_back(places[--ordered]);
    }
    if (i < places.size()) {
        std::ranges::copy(others, places.begin() + static_cast<std::ptrdiff_t>(ordered));
        tbb::parallel_sort(places.begin(), places.end());
        return;
    }
    tbb::parallel_sort(others.begin(), others.end());
    for (std::size_t to = places.size(), next = others.size(); next > 0;) {
        const bool from_others = ordered == 0 || places[ordered - 1] < others[next - 1];
        places[--to] = from_others ? others[--next] : places[--ordered];
    }
}

std::vector<Place> sorted_places(const Gaussians& model, const Affine& code_from) {
    std::vector<Place> places(model.size());
    for_all(places.size(), [&](std::size_t i) {
        const Vec3d at = code_from(vec_cast<double>(model.mean[i]));
        const auto cell = [](double v) {
            constexpr double kLast = (1 << kMortonAxisBits) - 1;
            return static_cast<std::uint64_t>(std::clamp(v, 0.0, kLast));
        };
        places[i] = {morton_code(cell(at.x), cell(at.y), cell(at.z)),
                     static_cast<std::uint32_t>(i)};
    });
    sort_places(places);
    return places;
}

/// Brings the arrays of a model whose elements are T into an order. They take turns in one further array, whose pages
/// are new to the process once, not for each of them.
template <class T>
void reorder(Gaussians& model, const std::vector<std::uint32_t>& order) {
    BigVector<T> ordered;
    const auto apply = [&](auto& values) {
        if constexpr (std::is_same_v<typename std::decay_t<decltype(values)>::value_type, T>) {
            if (values.empty()) return;
            ordered.resize(values.size());
            for_all(order.size(), [&](std::size_t i) { ordered[i] = values[order[i]]; });
            std::swap(values, ordered);
        }
    };
    apply(model.mean), apply(model.scale), apply(model.rotation), apply(model.density);
    each_array(apply, model.fields);
}

/// Sorted Gaussians [first, last).
struct Run {
    std::uint32_t first, last;
    std::uint32_t size() const { return last - first; }
};

/// Calls visit(run) for each occupied octant of the smallest cube around a cell: at least two.
template <class Visit>
void divide(std::span<const Place> places, Run cell, const Visit& visit) {
    const std::uint64_t differing = places[cell.first].code ^ places[cell.last - 1].code;
    if (differing == 0) {  // coincident means: parts of equal size
        for (std::uint32_t part = 0, first = cell.first; part < kMostChildren; ++part) {
            const auto last = static_cast<std::uint32_t>(
                cell.first + std::uint64_t{cell.size()} * (part + 1) / kMostChildren);
            visit(Run{std::exchange(first, last), last});
        }
        return;
    }
    const int shift = (static_cast<int>(std::bit_width(differing)) - 1) / 3 *
                      3;  // highest octal digit that differs
    for (std::uint32_t first = cell.first; first < cell.last;) {
        const std::uint64_t octant = places[first].code >> shift;
        const auto after =
            std::partition_point(places.begin() + first, places.begin() + cell.last,
                                 [&](const Place& place) { return place.code >> shift == octant; });
        const auto last = static_cast<std::uint32_t>(after - places.begin());
        visit(Run{std::exchange(first, last), last});
    }
}

/// Half the edge of the smallest octree cell around a run, world units; 0 for coincident means.
/// unit  world length of a step of the codes
float half_edge(std::span<const Place> places, Run run, double unit) {
    const std::uint64_t differing = places[run.first].code ^ places[run.last - 1].code;
    if (differing == 0) return 0;
    return static_cast<float>(
        std::ldexp(unit, (static_cast<int>(std::bit_width(differing)) - 1) / 3));
}

/// Children of a run of nodes of one level, in order.
struct Children {
    std::vector<Run> nodes;             ///< cells of the next level
    std::vector<std::uint32_t> leaves;  ///< single Gaussians
};

/// Appends the children of one cell and counts them.
void divide_node(std::span<const Place> places, Run cell, Children& children,
                 std::uint8_t& node_count, std::uint8_t& leaf_count) {
    const auto add = [&](Run part) {
        if (part.size() > 1) {
            children.nodes.push_back(part);
            ++node_count;
            return;
        }
        children.leaves.push_back(part.first);
        ++leaf_count;
    };
    if (cell.size() > kMostChildren)
        divide(places, cell, add);
    else
        for (std::uint32_t i = cell.first; i < cell.last; ++i) add({i, i + 1});
}

/// Appends one node for each cell of a level, and their leaves.
/// returns  the cells of the next level
std::vector<Run> add_level(std::span<const Place> places, std::span<const Run> cells, double unit,
                           Hierarchy& tree, std::vector<std::uint32_t>& leaves) {
    constexpr std::size_t kOfTask = 4096;
    const std::size_t before = tree.error.size();
    tree.node_count.resize(before + cells.size());
    tree.leaf_count.resize(before + cells.size());
    tree.error.resize(before + cells.size());
    std::vector<Children> tasks((cells.size() + kOfTask - 1) / kOfTask);
    vog::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t task) {
        const std::size_t end = std::min((task + 1) * kOfTask, cells.size());
        for (std::size_t i = task * kOfTask; i < end; ++i) {
            const std::size_t n = before + i;
            divide_node(places, cells[i], tasks[task], tree.node_count[n], tree.leaf_count[n]);
            tree.error[n] = half_edge(places, cells[i], unit);
        }
    });
    std::vector<Run> next;
    for (const Children& children : tasks) {
        next.insert(next.end(), children.nodes.begin(), children.nodes.end());
        leaves.insert(leaves.end(), children.leaves.begin(), children.leaves.end());
    }
    return next;
}

}  // namespace

MeanOctree mean_octree(Gaussians& model, const HierarchyOptions& options) {
    MeanOctree tree{{}, {0}};
    if (model.size() < 2) return tree;
    const Affine code_from = code_from_mean(model, options);
    const std::vector<Place> places = sorted_places(model, code_from);
    // World length of a step of the codes, the longest of the three axes.
    const Mat3 world_from_code = inverse(code_from.linear);
    const double unit =
        std::max({length(world_from_code.column(0)), length(world_from_code.column(1)),
                  length(world_from_code.column(2))});

    std::vector<std::uint32_t> leaves;  // indices into places, in the order of the tree
    leaves.reserve(places.size());
    std::vector<Run> cells{{0, static_cast<std::uint32_t>(places.size())}};
    while (!cells.empty()) {
        cells = add_level(places, cells, unit, tree.hierarchy, leaves);
        tree.levels.push_back(tree.hierarchy.error.size());
    }
    for_all(leaves.size(), [&](std::size_t i) { leaves[i] = places[leaves[i]].index; });
    reorder<float>(model, leaves);
    reorder<Vec3f>(model, leaves);
    reorder<Quat>(model, leaves);
    reorder<std::array<float, 6>>(model, leaves);
    return tree;
}

}  // namespace vog::lod
