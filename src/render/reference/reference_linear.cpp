// reference_linear.cpp: Integrates the trilinear field along a ray, block by block.
// A cell is the cube between eight voxel centres, and a block of 8^3 cells needs the values of its
// own leaf and of the seven above it in x, y and z. A cell that touches an active voxel lies in a
// leaf, a tile or a border tile, so the same traversal finds every block where the field is not 0.
#include "render/reference/reference_linear.h"

#include <array>

namespace vog::reference {

namespace {

/// Values of one block of 8^3 voxels: a leaf's table, or one value for all.
struct Values {
    const float* at = nullptr;
    std::uint32_t mask = 0;  ///< applied to offsets: 511 for a leaf, 0 for one value

    float operator[](std::uint32_t offset) const { return at[offset & mask]; }
};

constexpr float kEmpty = 0;

/// The block that contains this index.
Values find_block(const NanoRoot& root, const nanovdb::Coord& index) {
    const auto* cell = root.probeTile(index);
    if (!cell) return {&kEmpty, 0};
    if (!cell->isChild()) return {cell->isActive() ? &cell->value : &kEmpty, 0};
    const NanoUpper& upper = *root.data()->getChild(cell);
    const std::uint32_t in_upper = NanoUpper::CoordToOffset(index);
    if (!upper.childMask().isOn(in_upper))
        return {upper.valueMask().isOn(in_upper) ? &upper.data()->mTable[in_upper].value : &kEmpty,
                0};
    const NanoLower& lower = *upper.data()->getChild(in_upper);
    const std::uint32_t in_lower = NanoLower::CoordToOffset(index);
    if (!lower.childMask().isOn(in_lower))
        return {lower.valueMask().isOn(in_lower) ? &lower.data()->mTable[in_lower].value : &kEmpty,
                0};
    return {lower.data()->getChild(in_lower)->data()->mValues, kLeafVoxels - 1};
}

/// A block with the seven blocks above it, whose values its cells interpolate.
class Block {
  public:
    Block(const NanoRoot& root, Vec3d index, Vec3d lower) : lower_(lower) {
        for (int n = 0; n < 8; ++n)
            values_[static_cast<std::size_t>(n)] =
                find_block(root, {static_cast<int>(index.x) + (n & 4 ? kLeafEdge : 0),
                                  static_cast<int>(index.y) + (n & 2 ? kLeafEdge : 0),
                                  static_cast<int>(index.z) + (n & 1 ? kLeafEdge : 0)});
    }

    /// The field at a local point, which is clamped to the block against rounding.
    double operator()(Vec3d point) const {
        // Along each axis: the blocks of the two planes of centres around the point, their parts of
        // the offset in these blocks, and the weight of the second plane.
        std::uint32_t block[3][2], offset[3][2];
        double w[3];
        for (int axis = 0; axis < 3; ++axis) {
            const double at = point[axis] - lower_[axis];
            const int cell = std::clamp(static_cast<int>(at), 0, kLeafEdge - 1);
            w[axis] = at - cell;
            for (int side = 0; side < 2; ++side) {
                const auto plane = static_cast<std::uint32_t>(cell + side);
                block[axis][side] = plane >> 3 << (2 - axis);
                offset[axis][side] = (plane & 7) << 3 * (2 - axis);
            }
        }
        const auto row = [&](int x, int y) {
            const std::uint32_t b = block[0][x] | block[1][y], o = offset[0][x] | offset[1][y];
            return mix(values_[b | block[2][0]][o | offset[2][0]],
                       values_[b | block[2][1]][o | offset[2][1]], w[2]);
        };
        return mix(mix(row(0, 0), row(0, 1), w[1]), mix(row(1, 0), row(1, 1), w[1]), w[0]);
    }
    Vec3d lower() const { return lower_; }

  private:
    static double mix(double a, double b, double t) { return a + t * (b - a); }

    Vec3d lower_;
    std::array<Values, 8> values_;
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

/// Two-point Gauss rule in each cell, exact: within a cell the field along a ray is a cubic.
struct GaussPoints {
    double integrate(const GridRay& ray, Segment segment, const Block& block) const {
        constexpr double kOffset = 0.57735026918962576;  // 1/sqrt(3)
        double sum = 0;
        for_each_cell<3>(ray, block.lower(), 1, segment, [&](std::uint32_t, Segment part) {
            const double middle = 0.5 * (part.first + part.last);
            const double half = 0.5 * (part.last - part.first);
            sum += half * (block(ray.origin + (middle - kOffset * half) * ray.direction) +
                           block(ray.origin + (middle + kOffset * half) * ray.direction));
        });
        return sum;
    }
    double constant(float value, Segment segment) const {
        return value * (segment.last - segment.first);
    }
};

template <class Rule>
struct LinearSum {
    const VoxelGrid::Data& grid;
    const GridRay& ray;
    Rule rule;
    double sum = 0;

    void leaf(const NanoLeaf&, Vec3d lower, Segment segment) { block(lower, segment); }

    void tile(Vec3d lower, int edge, float value, Segment segment) {
        // Constant except in the last layer of cells, which also uses the blocks above the tile.
        const double inside = edge - 1;
        const Segment middle = clip(ray, lower, lower + Vec3d{inside, inside, inside}, segment);
        if (middle.empty()) return blocks(lower, edge, segment);
        sum += rule.constant(value, middle);
        blocks(lower, edge, {segment.first, middle.first});
        blocks(lower, edge, {middle.last, segment.last});
    }

    /// Integrates every block of a tile along the segment.
    void blocks(Vec3d lower, int edge, Segment segment) {
        const auto walk = [&]<int Log2Cells>() {
            for_each_cell<Log2Cells>(
                ray, lower, kLeafEdge, segment, [&](std::uint32_t offset, Segment part) {
                    block(cell_lower<Log2Cells>(lower, kLeafEdge, offset), part);
                });
        };
        if (segment.empty()) return;
        if (edge == kLeafEdge)
            block(lower, segment);
        else if (edge == static_cast<int>(NanoLower::DIM))
            walk.template operator()<4>();
        else
            walk.template operator()<9>();
    }

    void block(Vec3d lower, Segment segment) {
        sum += rule.integrate(ray, segment, Block(grid.tree.root(), lower + grid.corner, lower));
    }
};

}  // namespace

double linear_sum(const VoxelGrid::Data& grid, const GridRay& ray, Segment within) {
    const auto integrate = [&](auto rule) {
        LinearSum<decltype(rule)> linear{grid, ray, rule};
        march(grid.root_cells, ray, linear, within);
        return linear.sum;
    };
    const double step = grid.options.step_voxels;
    if (step == 0) return integrate(GaussPoints{});

    // A whole number of steps over the part of the ray within the box of the grid and the segment.
    const auto& box = grid.tree.root().bbox();
    const Vec3d size{double(box.dim()[0]), double(box.dim()[1]), double(box.dim()[2])};
    const Segment whole = clip(ray, {0, 0, 0}, size, within);
    if (whole.empty()) return 0;
    const double interval = whole.last - whole.first;
    const double steps = std::ceil(interval * length(ray.direction) / step);
    return integrate(Midpoints{whole.first, interval / steps});
}

}  // namespace vog::reference
