// hierarchical_dda.h: the hierarchical DDA. One ray through root, internal nodes, tiles and leaves
// of a NanoVDB grid; what holds nothing is crossed in one step at its own level.
//
// A node gets the segment [t0, t1] of the ray and gives every point of it to exactly one of its
// cells, whose own segment is then the child's. Pieces of a ray therefore never overlap and never
// leave a gap, also along edges, through corners and in the planes between voxels: rounding can
// only move a boundary by an ulp. NanoVDB's own HDDA.h steps in float and offsets the ray by an
// epsilon at each node, which at index 10^6 is wider than a voxel.
//
// Coordinates are local: index space less the grid's own corner, in double, so that far grids keep
// all their digits. A cell at c covers [c, c + edge): the caller has moved the ray by half a voxel
// where voxels are centred on their index.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/reference/nano_tree.h"
#include "vog/linear.h"

namespace vog::reference {

/// origin + t direction, t in the units the caller's direction has in world space.
struct GridRay {
    Vec3d origin, direction;
    Vec3d inverse;  ///< of the direction; unused where that is 0

    GridRay(Vec3d from, Vec3d along) : origin(from), direction(along) {
        // Below this share of the longest component, an axis moves by less than 2^-32 voxel across
        // the largest grid (2^32 voxels): call it 0, so that no product is infinity times 0.
        const double longest = std::max({std::abs(along.x), std::abs(along.y), std::abs(along.z)});
        for (int axis = 0; axis < 3; ++axis) {
            if (std::abs(along[axis]) < 0x1p-66 * longest) direction[axis] = 0;
            inverse[axis] = 1 / direction[axis];
        }
    }
    /// When the ray meets the plane at this coordinate. Monotonic in `plane`, rounding included,
    /// so two cells that share a face agree on its time.
    double time(int axis, double plane) const { return (plane - origin[axis]) * inverse[axis]; }
};

/// A stretch of the ray; empty if first >= last.
struct Segment {
    double first = 0, last = std::numeric_limits<double>::infinity();
    bool empty() const { return !(first < last); }
};

/// The part of `segment` in the box [lower, upper). A ray that runs within a face belongs to the
/// box whose lower face it is.
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

/// Walks the cells of a cube of (2^Log2Cells)^3 cells of this edge along a segment that lies inside
/// it, and calls visit(offset, part) with the cell's offset in the cube's table (z fastest) and its
/// part of the segment.
template <int Log2Cells, class Visit>
void for_each_cell(const GridRay& ray, Vec3d lower, double edge, Segment segment, Visit&& visit) {
    constexpr int kCells = 1 << Log2Cells;
    double next[3], period[3];  // time of leaving the cell through an axis; time between two faces
    int step[3], left[3];       // of the offset; cells left before the cube's face
    int offset = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double at = ray.origin[axis] + segment.first * ray.direction[axis] - lower[axis];
        // Rounding may put the entry an ulp outside the cube: it enters by the first cell.
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
    // No branch in the choice of the axis: mispredicted, it would cost more than the step. A ray
    // through an edge or a corner steps along two or three axes at once. Where rounding has the
    // cube end before its segment does, the walk ends at the face: a ray that runs beside a voxel
    // meets exactly nothing of it.
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

/// Meets an internal node's children and active tiles.
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

/// Meets every leaf and active tile on the ray, within a segment of it:
///   visitor.leaf(const NanoLeaf&, Vec3d lower, Segment)
///   visitor.tile(Vec3d lower, int edge, float value, Segment)
/// corner  index of the local origin
template <class Visitor>
void march(const NanoRoot& root, Vec3d corner, const GridRay& ray, Visitor&& visitor,
           Segment within = {}) {
    const auto local = [&](const nanovdb::Coord& index) {
        return Vec3d{double(index[0]), double(index[1]), double(index[2])} - corner;
    };
    // The root's cells are few and may lie anywhere in 2^32 voxels: test each rather than walk.
    // Cells that share a face agree on its time, so here too nothing is missed or doubled.
    const auto& data = *root.data();
    for (std::uint32_t i = 0; i < data.mTableSize; ++i) {
        const auto& cell = *data.tile(i);
        if (cell.isChild()) {
            const NanoUpper& upper = *data.getChild(&cell);
            const Segment segment = clip(ray, local(upper.bbox().min()),
                                         local(upper.bbox().max()) + Vec3d{1, 1, 1}, within);
            if (!segment.empty()) march_node(upper, ray, local(upper.origin()), segment, visitor);
        } else if (cell.isActive()) {
            constexpr double kEdge = NanoUpper::DIM;
            const Vec3d lower = local(cell.origin());
            const Segment segment = clip(ray, lower, lower + Vec3d{kEdge, kEdge, kEdge}, within);
            if (!segment.empty())
                visitor.tile(lower, static_cast<int>(NanoUpper::DIM), cell.value, segment);
        }
    }
}

}  // namespace vog::reference
