// hierarchical_dda.h: Hierarchical DDA: one ray through root, internal nodes, tiles and leaves of a
// NanoVDB grid, with empty cells crossed in one step at their own level.
//
// A node divides its segment [t0, t1] of the ray among its cells, each point to exactly one of them,
// and a cell's part is the segment of the child. Segments therefore neither overlap nor leave gaps,
// also along edges, through corners and in the planes between voxels: rounding can only move a
// boundary by an ulp. NanoVDB's own HDDA.h steps in float and offsets the ray by an epsilon at each
// node, which at index 10^6 is wider than a voxel.
//
// Coordinates are local: index space minus the lower corner of the grid, in double, so that grids
// far from index 0 lose no digits. A cell at c covers [c, c + edge); for voxels centred on their
// index the caller shifts the ray by half a voxel.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "render/reference/nano_tree.h"
#include "render/reference/root_cells.h"
#include "vog/linear.h"

namespace vog::reference {

/// Ray origin + t direction in local coordinates, with the same t as the ray in world space.
struct GridRay {
    Vec3d origin, direction;
    Vec3d inverse;  ///< 1 / direction; unused where that is 0

    GridRay(Vec3d from, Vec3d along) : origin(from), direction(along) {
        // Below this fraction of the longest component the ray moves less than 2^-32 voxels across
        // the largest grid (2^32 voxels): set to 0, so that no product is infinity times 0.
        const double longest = std::max({std::abs(along.x), std::abs(along.y), std::abs(along.z)});
        for (int axis = 0; axis < 3; ++axis) {
            if (std::abs(along[axis]) < 0x1p-66 * longest) direction[axis] = 0;
            inverse[axis] = 1 / direction[axis];
        }
    }
    /// t at which the ray crosses the plane at this coordinate. Monotonic in `plane`, rounding
    /// included, so two cells that share a face compute the same t.
    double time(int axis, double plane) const { return (plane - origin[axis]) * inverse[axis]; }
};

/// Interval of t along the ray; empty if first >= last.
struct Segment {
    double first = 0, last = std::numeric_limits<double>::infinity();
    bool empty() const { return !(first < last); }
};

/// The part of `segment` in the box [lower, upper). A ray inside a face belongs to the box with that
/// lower face.
inline Segment clip(const GridRay& ray, Vec3d lower, Vec3d upper, Segment segment = {}) {
    for (int axis = 0; axis < 3; ++axis) {
        if (ray.direction[axis] == 0) {
            if (!(lower[axis] <= ray.origin[axis] && ray.origin[axis] < upper[axis])) return {0, 0};
            continue;
        }
        const double to_lower = ray.time(axis, lower[axis]);
        const double to_upper = ray.time(axis, upper[axis]);
        segment.first = std::max(segment.first, std::min(to_lower, to_upper));
        segment.last = std::min(segment.last, std::max(to_lower, to_upper));
    }
    return segment;
}

/// Calls visit(offset, part) for each cell along a segment inside a cube of (2^Log2Cells)^3 cells:
/// the cell's offset in the cube's table (z fastest) and its part of the segment.
/// edge  of a cell
template <int Log2Cells, class Visit>
void for_each_cell(const GridRay& ray, Vec3d lower, double edge, Segment segment, Visit&& visit) {
    constexpr int kCells = 1 << Log2Cells;
    double next[3], period[3];  // t of the next face along an axis; t between two faces
    int step[3], left[3];       // change of the offset; cells left before the cube's face
    int offset = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double at = ray.origin[axis] + segment.first * ray.direction[axis] - lower[axis];
        // Rounding may put the entry an ulp outside the cube: clamp to the first cell.
        const int cell = static_cast<int>(std::clamp(at / edge, 0.0, kCells - 1.0));
        const int shift = (2 - axis) * Log2Cells;
        const bool up = ray.direction[axis] > 0;
        offset |= cell << shift;
        step[axis] = up ? 1 << shift : -(1 << shift);
        left[axis] = up ? kCells - 1 - cell : cell;
        next[axis] = ray.direction[axis] == 0 ? std::numeric_limits<double>::infinity()
                                              : ray.time(axis, lower[axis] + edge * (cell + up));
        period[axis] = edge * std::abs(ray.inverse[axis]);
    }
    // No branch on the axis: mispredictions would cost more than the step. A ray through an edge or
    // a corner steps along two or three axes at once. If by rounding the cube ends before its
    // segment, the walk ends at the face, so that a ray beside a voxel adds exactly 0.
    double now = segment.first;
    while (true) {
        const double crossing = std::min({next[0], next[1], next[2]});
        const double leave = std::min(crossing, segment.last);
        if (leave > now) {
            visit(static_cast<std::uint32_t>(offset), Segment{now, leave});
            now = leave;
        }
        if (!(crossing < segment.last)) return;
        for (int axis = 0; axis < 3; ++axis) {
            const bool crossed = next[axis] == crossing;
            next[axis] += crossed ? period[axis] : 0.0;
            offset += crossed ? step[axis] : 0;
            left[axis] -= crossed;
        }
        if ((left[0] | left[1] | left[2]) < 0) return;
    }
}

/// Lower corner of the cell at this offset of for_each_cell.
template <int Log2Cells>
Vec3d cell_lower(Vec3d lower, double edge, std::uint32_t offset) {
    constexpr std::uint32_t kMask = (1u << Log2Cells) - 1;
    return lower + edge * Vec3d{double(offset >> 2 * Log2Cells),
                                double(offset >> Log2Cells & kMask), double(offset & kMask)};
}

/// Visits children and active tiles of an internal node along a segment.
template <class Node, class Visitor>
void march_node(const Node& node, const GridRay& ray, Vec3d lower, Segment segment,
                Visitor& visitor) {
    using Child = typename Node::ChildNodeType;
    constexpr int kLog2Cells = static_cast<int>(Node::LOG2DIM);
    constexpr int kEdge = static_cast<int>(Child::DIM);
    const auto& data = *node.data();
    for_each_cell<kLog2Cells>(ray, lower, kEdge, segment, [&](std::uint32_t offset, Segment part) {
        const auto at = [&] { return cell_lower<kLog2Cells>(lower, kEdge, offset); };
        if (data.mChildMask.isOn(offset)) {
            const Child& child = *data.getChild(offset);
            if constexpr (Child::LEVEL == 0)
                visitor.leaf(child, at(), part);
            else
                march_node(child, ray, at(), part, visitor);
        } else if (data.mValueMask.isOn(offset)) {
            visitor.tile(at(), kEdge, data.getValue(offset), part);
        }
    });
}

/// Calls visit(cell, part) for each cell of the root on a ray, within a segment of it.
template <class Visit>
void for_each_root_cell(const RootCells& cells, const GridRay& ray, Segment within, Visit&& visit) {
    const std::vector<RootCells::Node>& nodes = cells.nodes();
    for (std::size_t n = 0; n < nodes.size();) {
        const RootCells::Node& node = nodes[n];
        if (clip(ray, node.lower, node.upper, within).empty()) {
            n = node.skip;
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            const Segment segment = clip(ray, cells[i].lower, cells[i].upper, within);
            if (!segment.empty()) visit(cells[i], segment);
        }
        ++n;
    }
}

/// Visits one cell of the root along a segment.
template <class Visitor>
void march_cell(const RootCell& cell, const GridRay& ray, Segment segment, Visitor& visitor) {
    if (cell.child)
        march_node(*cell.child, ray, cell.origin, segment, visitor);
    else
        visitor.tile(cell.origin, static_cast<int>(NanoUpper::DIM), cell.value, segment);
}

/// Visits every leaf and active tile on the ray, within a segment of it:
///   visitor.leaf(const NanoLeaf&, Vec3d lower, Segment)
///   visitor.tile(Vec3d lower, int edge, float value, Segment)
/// Cells of the root that share a face compute the same t for it, so here too no part is missed or
/// doubled.
template <class Visitor>
void march(const RootCells& cells, const GridRay& ray, Visitor&& visitor, Segment within = {}) {
    for_each_root_cell(cells, ray, within, [&](const RootCell& cell, Segment segment) {
        march_cell(cell, ray, segment, visitor);
    });
}

/// The same from the front to the back: the cells of the root, which march meets in the order of their
/// hierarchy, are sorted by the ray's entry.
template <class Visitor>
void march_in_order(const RootCells& cells, const GridRay& ray, Visitor&& visitor,
                    Segment within = {}) {
    struct Entry {
        Segment segment;
        const RootCell* cell;
    };
    thread_local std::vector<Entry> entries;
    entries.clear();
    for_each_root_cell(cells, ray, within, [&](const RootCell& cell, Segment segment) {
        entries.push_back({segment, &cell});
    });
    std::sort(entries.begin(), entries.end(),
              [](const Entry& a, const Entry& b) { return a.segment.first < b.segment.first; });
    for (const Entry& entry : entries) march_cell(*entry.cell, ray, entry.segment, visitor);
}

}  // namespace vog::reference
