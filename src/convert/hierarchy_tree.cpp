// hierarchy_tree.cpp: Morton codes of the means, sorted; each cell of the octree is then a run of
// them, found by bisection.
#include "convert/hierarchy_tree.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include "parallel.h"

namespace vog {

namespace {

/// Place on the curve, and which Gaussian: what is sorted.
struct Place {
    std::uint64_t code = 0;
    std::uint32_t index = 0;
    friend bool operator<(const Place& a, const Place& b) {
        return std::tie(a.code, a.index) < std::tie(b.code, b.index);
    }
};

constexpr int kAxisBits = 21;  // three times this fit one word

/// The lower 21 bits, each followed by two zeros.
std::uint64_t spread_bits(std::uint64_t v) {
    v &= (1u << kAxisBits) - 1;
    v = (v | v << 32) & 0x1f00000000ffff;
    v = (v | v << 16) & 0x1f0000ff0000ff;
    v = (v | v << 8) & 0x100f00f00f00f00f;
    v = (v | v << 4) & 0x10c30c30c30c30c3;
    return (v | v << 2) & 0x1249249249249249;
}

/// From the world to the lattice of the codes, whose coordinates are in [0, 2^21).
Affine code_from_world(const Gaussians& model, const HierarchyOptions& options) {
    constexpr double kSide = 1 << kAxisBits;
    Box means;
    const Affine& lattice = options.index_from_world.value_or(Affine{});
    for (const Vec3f& mean : model.mean) means.include(lattice(vec_cast<double>(mean)));
    const Vec3d edges = means.upper - means.lower;
    const double edge = std::max({edges.x, edges.y, edges.z});
    double scale = 1;
    Vec3d shift;
    if (options.index_from_world && edge < 0.25 * kSide) {
        // Cells of 2^n voxels begin at multiples of 2^n: so may the codes, shifted by a large one.
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

std::vector<Place> sorted_places(const Gaussians& model, const Affine& code_from) {
    std::vector<Place> places(model.size());
    for_all(places.size(), [&](std::size_t i) {
        const Vec3d at = code_from(vec_cast<double>(model.mean[i]));
        const auto bits = [](double v) {
            constexpr double kLast = (1 << kAxisBits) - 1;
            return spread_bits(static_cast<std::uint64_t>(std::clamp(v, 0.0, kLast)));
        };
        places[i] = {bits(at.x) << 2 | bits(at.y) << 1 | bits(at.z), static_cast<std::uint32_t>(i)};
    });
    // Cells of a conversion come in this order.
    if (!std::is_sorted(places.begin(), places.end()))
        tbb::parallel_sort(places.begin(), places.end());
    return places;
}

template <class T>
void reorder(BigVector<T>& values, const std::vector<Place>& places) {
    if (values.empty()) return;
    BigVector<T> ordered(values.size());
    for_all(places.size(), [&](std::size_t i) { ordered[i] = values[places[i].index]; });
    values = std::move(ordered);
}

/// Gaussians first ... last - 1 of the order.
struct Run {
    std::uint32_t first, last;
    std::uint32_t size() const { return last - first; }
};

/// Calls visit(run) for the parts of a cell, of which there are at least two.
template <class Visit>
void divide(std::span<const Place> places, Run cell, const Visit& visit) {
    const std::uint64_t differing = places[cell.first].code ^ places[cell.last - 1].code;
    if (differing == 0) {  // all in one place: any halves will do
        for (std::uint32_t part = 0, first = cell.first; part < kMostChildren; ++part) {
            const auto last = static_cast<std::uint32_t>(
                cell.first + std::uint64_t{cell.size()} * (part + 1) / kMostChildren);
            visit(Run{std::exchange(first, last), last});
        }
        return;
    }
    const int shift = (static_cast<int>(std::bit_width(differing)) - 1) / 3 *
                      3;  // of the digit that tells octants
    for (std::uint32_t first = cell.first; first < cell.last;) {
        const std::uint64_t octant = places[first].code >> shift;
        const auto after =
            std::partition_point(places.begin() + first, places.begin() + cell.last,
                                 [&](const Place& place) { return place.code >> shift == octant; });
        const auto last = static_cast<std::uint32_t>(after - places.begin());
        visit(Run{std::exchange(first, last), last});
    }
}

/// Half the edge of the smallest cell of the octree that holds a run, where a step of the codes is
/// `unit`; 0 where all are in one place.
float half_edge(std::span<const Place> places, Run run, double unit) {
    const std::uint64_t differing = places[run.first].code ^ places[run.last - 1].code;
    if (differing == 0) return 0;
    return static_cast<float>(
        std::ldexp(unit, (static_cast<int>(std::bit_width(differing)) - 1) / 3));
}

/// Nodes of a cell and below, depth first. Single Gaussians are no nodes.
void grow(std::span<const Place> places, Run cell, std::vector<Run>& nodes) {
    if (cell.size() < 2) return;
    nodes.push_back(cell);
    if (cell.size() > kMostChildren)
        divide(places, cell, [&](Run part) { grow(places, part, nodes); });
}

/// A part of the tree, in depth-first order of all: a large node alone, or a whole subtree.
struct Piece {
    Run cell;
    bool whole = false;
    std::vector<Run> nodes{};
};

void cut_to_pieces(std::span<const Place> places, Run cell, std::vector<Piece>& pieces) {
    constexpr std::uint32_t kWhole = 1 << 15;  // Gaussians of a task
    pieces.push_back({cell, cell.size() <= kWhole});
    if (cell.size() > kWhole)
        divide(places, cell, [&](Run part) { cut_to_pieces(places, part, pieces); });
}

}  // namespace

Hierarchy hierarchy_tree(Gaussians& model, const HierarchyOptions& options) {
    Hierarchy tree;
    if (model.size() < 2) return tree;
    const Affine code_from = code_from_world(model, options);
    const std::vector<Place> places = sorted_places(model, code_from);
    reorder(model.mean, places);
    reorder(model.scale, places);
    reorder(model.rotation, places);
    reorder(model.density, places);

    // World length of a code's step, the longest of the three.
    const Mat3 world_from_code = inverse(code_from.linear);
    const double unit =
        std::max({length(world_from_code.column(0)), length(world_from_code.column(1)),
                  length(world_from_code.column(2))});
    std::vector<Piece> pieces;
    cut_to_pieces(places, {0, static_cast<std::uint32_t>(places.size())}, pieces);
    vog::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t n) {
        Piece& piece = pieces[n];
        if (piece.whole)
            grow(places, piece.cell, piece.nodes);
        else
            piece.nodes.push_back(piece.cell);
    });
    for (const Piece& piece : pieces)
        for (const Run& node : piece.nodes) {
            tree.first.push_back(node.first);
            tree.count.push_back(node.size());
            tree.error.push_back(half_edge(places, node, unit));
        }
    return tree;
}

}  // namespace vog
