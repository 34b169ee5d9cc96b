// linear_block.h: The trilinear field between voxel centres, block by block along a ray.
// A cell is the cube between eight voxel centres, and a block of 8^3 cells needs the values of its
// own leaf and of the seven above it in x, y and z. A cell that touches an active voxel lies in a
// leaf, a tile or a border tile, so the traversal of the tree finds every block where the field is not 0.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "render/reference/hierarchical_dda.h"

namespace vog::reference {

/// Values of one block of 8^3 voxels: a leaf's table, or one value for all.
struct BlockValues {
    const float* at = nullptr;
    std::uint32_t mask = 0;  ///< applied to offsets: 511 for a leaf, 0 for one value

    float operator[](std::uint32_t offset) const { return at[offset & mask]; }
};

inline constexpr float kEmpty = 0;

/// The node of 16^3 blocks that contains this index.
/// one  set where there is none: its one value
inline const NanoLower* find_lower(const NanoRoot& root, const nanovdb::Coord& index,
                                   BlockValues& one) {
    one = {&kEmpty, 0};
    const auto* cell = root.probeTile(index);
    if (!cell) return nullptr;
    if (!cell->isChild()) {
        if (cell->isActive()) one.at = &cell->value;
        return nullptr;
    }
    const NanoUpper& upper = *root.data()->getChild(cell);
    const std::uint32_t offset = NanoUpper::CoordToOffset(index);
    if (upper.childMask().isOn(offset)) return upper.data()->getChild(offset);
    if (upper.valueMask().isOn(offset)) one.at = &upper.data()->mTable[offset].value;
    return nullptr;
}

/// The block of a node that contains this index.
inline BlockValues block_of(const NanoLower& lower, const nanovdb::Coord& index) {
    const std::uint32_t offset = NanoLower::CoordToOffset(index);
    if (lower.childMask().isOn(offset))
        return {lower.data()->getChild(offset)->data()->mValues, kLeafVoxels - 1};
    return {lower.valueMask().isOn(offset) ? &lower.data()->mTable[offset].value : &kEmpty, 0};
}

/// The block that contains this index.
inline BlockValues find_block(const NanoRoot& root, const nanovdb::Coord& index) {
    BlockValues one;
    const NanoLower* lower = find_lower(root, index, one);
    return lower ? block_of(*lower, index) : one;
}

/// A block with the seven blocks above it, whose values its cells interpolate.
class Block {
  public:
    Block(const NanoRoot& root, Vec3d index, Vec3d lower) : lower_(lower) {
        const nanovdb::Coord own(static_cast<int>(index.x), static_cast<int>(index.y),
                                 static_cast<int>(index.z));
        // Most blocks share a node with those above them.
        constexpr int kLast = static_cast<int>(NanoLower::DIM) - kLeafEdge;
        BlockValues one;
        const NanoLower* node = find_lower(root, own, one);
        for (int axis = 0; axis < 3; ++axis)
            if ((own[axis] & (static_cast<int>(NanoLower::DIM) - 1)) == kLast) node = nullptr;
        for (int n = 0; n < 8; ++n) {
            const nanovdb::Coord at =
                own.offsetBy(n & 4 ? kLeafEdge : 0, n & 2 ? kLeafEdge : 0, n & 1 ? kLeafEdge : 0);
            values_[static_cast<std::size_t>(n)] =
                node ? block_of(*node, at) : find_block(root, at);
        }
    }

    /// The field at a local point, which is clamped to the block against rounding.
    double operator()(Vec3d point) const { return at(point).value(); }

    /// Values of the eight voxels around a point, and its place between them.
    struct Cell {
        double corner[2][2][2];  ///< [x][y][z]
        double w[3];             ///< weights of the upper planes, [0, 1]
        int voxel[3];            ///< the first corner, from the block's

        void move_to(Vec3d local) {
            for (int axis = 0; axis < 3; ++axis) w[axis] = local[axis] - voxel[axis];
        }
        double value() const {
            return mix(mix(along_z(0, 0), along_z(0, 1), w[1]),
                       mix(along_z(1, 0), along_z(1, 1), w[1]), w[0]);
        }

      private:
        double along_z(int x, int y) const { return mix(corner[x][y][0], corner[x][y][1], w[2]); }
        static double mix(double a, double b, double t) { return a + t * (b - a); }
    };
    Cell at(Vec3d point) const {
        const Vec3d local = point - lower_;
        Cell made;
        for (int axis = 0; axis < 3; ++axis)
            made.voxel[axis] = std::clamp(static_cast<int>(local[axis]), 0, kLeafEdge - 1);
        take_corners(made);
        made.move_to(local);
        return made;
    }
    /// The cell at an offset of for_each_cell<3>, at no place in it.
    Cell cell(std::uint32_t offset) const {
        Cell made;
        for (int axis = 0; axis < 3; ++axis)
            made.voxel[axis] = static_cast<int>(offset >> 3 * (2 - axis) & 7);
        take_corners(made);
        return made;
    }
    Vec3d lower() const { return lower_; }

  private:
    void take_corners(Cell& made) const {
        const auto& [x0, y0, z0] = made.voxel;
        if (std::max({x0, y0, z0}) < kLeafEdge - 1) {  // in the block itself
            for (std::uint32_t n = 0; n < 8; ++n)
                made.corner[n >> 2][n >> 1 & 1][n & 1] =
                    double{values_[0][static_cast<std::uint32_t>(x0 << 6 | y0 << 3 | z0) +
                                      (n >> 2 << 6 | (n >> 1 & 1) << 3 | (n & 1))]};
            return;
        }
        // Along each axis: the blocks of the two planes of centres around the cell, and their parts of the offset in these blocks.
        std::uint32_t block[3][2], offset[3][2];
        for (int axis = 0; axis < 3; ++axis)
            for (int side = 0; side < 2; ++side) {
                const auto plane = static_cast<std::uint32_t>(made.voxel[axis] + side);
                block[axis][side] = plane >> 3 << (2 - axis);
                offset[axis][side] = (plane & 7) << 3 * (2 - axis);
            }
        for (int x = 0; x < 2; ++x)
            for (int y = 0; y < 2; ++y)
                for (int z = 0; z < 2; ++z)
                    made.corner[x][y][z] =
                        double{values_[block[0][x] | block[1][y] | block[2][z]]
                                      [offset[0][x] | offset[1][y] | offset[2][z]]};
    }

    Vec3d lower_;
    std::array<BlockValues, 8> values_;
};

/// Gradients in a block: central differences at voxel centres, trilinear between these.
class BlockGradient {
  public:
    BlockGradient(const NanoRoot& root, Vec3d index) {
        for (int n = 0; n < 27; ++n) {
            const auto along = [&](double first, int block) {
                return static_cast<int>(first) + (block % 3 - 1) * kLeafEdge;
            };
            values_[static_cast<std::size_t>(n)] =
                find_block(root, {along(index.x, n / 9), along(index.y, n / 3), along(index.z, n)});
        }
    }
    /// Per voxel.
    Vec3d operator()(const Block::Cell& cell) const {
        // Along each axis: the planes before the cell, of its corners, and behind it.
        std::uint32_t block[3][4], offset[3][4];
        for (int axis = 0; axis < 3; ++axis)
            for (int n = 0; n < 4; ++n) {
                const auto plane = static_cast<std::uint32_t>(cell.voxel[axis] + n - 1 + kLeafEdge);
                block[axis][n] = plane >> 3;
                offset[axis][n] = (plane & 7) << 3 * (2 - axis);
            }
        const auto value = [&](int x, int y, int z) {
            return double{values_[9 * block[0][x] + 3 * block[1][y] + block[2][z]]
                                 [offset[0][x] | offset[1][y] | offset[2][z]]};
        };
        Vec3d sum;
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b) {
                const auto weight = [&](int first, int second) {
                    return 0.5 * (a ? cell.w[first] : 1 - cell.w[first]) *
                           (b ? cell.w[second] : 1 - cell.w[second]);
                };
                // Central differences at both ends of an edge of the cell, from the four values along it.
                const auto slope = [](double w, double v0, double v1, double v2, double v3) {
                    return (1 - w) * (v2 - v0) + w * (v3 - v1);
                };
                const auto& corner = cell.corner;
                sum.x += weight(1, 2) * slope(cell.w[0], value(0, a + 1, b + 1), corner[0][a][b],
                                              corner[1][a][b], value(3, a + 1, b + 1));
                sum.y += weight(0, 2) * slope(cell.w[1], value(a + 1, 0, b + 1), corner[a][0][b],
                                              corner[a][1][b], value(a + 1, 3, b + 1));
                sum.z += weight(0, 1) * slope(cell.w[2], value(a + 1, b + 1, 0), corner[a][b][0],
                                              corner[a][b][1], value(a + 1, b + 1, 3));
            }
        return sum;
    }

  private:
    std::array<BlockValues, 27> values_;  ///< the block's own in the middle
};

/// Midpoint rule with samples at start + (k + 1/2) spacing, so that their positions do not depend on
/// the tree. first(t) is monotonic: each sample belongs to exactly one segment.
struct Midpoints {
    double start = 0, spacing = 1;

    double first(double t) const { return std::ceil((t - start) / spacing - 0.5); }
    double count(Segment s) const { return first(s.last) - first(s.first); }

    template <class Field>
    double integrate(const GridRay& ray, Segment segment, const Field& field) const {
        double sum = 0;
        for (double k = first(segment.first), end = first(segment.last); k < end; ++k)
            sum += field(ray.origin + (start + (k + 0.5) * spacing) * ray.direction);
        return sum * spacing;
    }
    double constant(float value, Segment segment) const { return value * count(segment) * spacing; }
};

/// Calls visit(lower, part) for every block of a tile along a segment.
/// edge  of the tile, voxels
template <class Visit>
void for_each_block(const GridRay& ray, Vec3d lower, int edge, Segment segment, Visit&& visit) {
    const auto walk = [&]<int Log2Cells>() {
        for_each_cell<Log2Cells>(ray, lower, kLeafEdge, segment,
                                 [&](std::uint32_t offset, Segment part) {
                                     visit(cell_lower<Log2Cells>(lower, kLeafEdge, offset), part);
                                 });
    };
    if (segment.empty()) return;
    if (edge == kLeafEdge)
        visit(lower, segment);
    else if (edge == static_cast<int>(NanoLower::DIM))
        walk.template operator()<4>();
    else
        walk.template operator()<9>();
}

}  // namespace vog::reference
