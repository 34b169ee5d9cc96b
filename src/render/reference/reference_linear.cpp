// reference_linear.cpp: samples of the trilinear field, block by block.
// A block of 8^3 cells between voxel centres needs its own leaf and the seven above it; a cell is
// the cube between eight centres, and one that touches an active voxel lies in a leaf, in a tile or
// in a border tile. So the same march finds every block that can hold anything.
#include "render/reference/reference_linear.h"

#include <array>

namespace vog::reference {

namespace {

/// Where the values of one block of 8^3 voxels are: a leaf's table, or one value for all.
struct Values {
    const float* at = nullptr;
    std::uint32_t mask = 0;  ///< of offsets: 511 for a leaf, 0 for one value

    float operator[](std::uint32_t offset) const { return at[offset & mask]; }
};

constexpr float kNothing = 0;

/// The values of the block that holds this index.
Values find_block(const NanoRoot& root, const nanovdb::Coord& index) {
    const auto* cell = root.probeTile(index);
    if (!cell) return {&kNothing, 0};
    if (!cell->isChild()) return {cell->isActive() ? &cell->value : &kNothing, 0};
    const NanoUpper& upper = *root.data()->getChild(cell);
    const std::uint32_t in_upper = NanoUpper::CoordToOffset(index);
    if (!upper.childMask().isOn(in_upper))
        return {
            upper.valueMask().isOn(in_upper) ? &upper.data()->mTable[in_upper].value : &kNothing,
            0};
    const NanoLower& lower = *upper.data()->getChild(in_upper);
    const std::uint32_t in_lower = NanoLower::CoordToOffset(index);
    if (!lower.childMask().isOn(in_lower))
        return {
            lower.valueMask().isOn(in_lower) ? &lower.data()->mTable[in_lower].value : &kNothing,
            0};
    return {lower.data()->getChild(in_lower)->data()->mValues, kLeafVoxels - 1};
}

/// A block with the lower layers of the blocks above it: all that its cells interpolate.
class Block {
  public:
    Block(const NanoRoot& root, Vec3d index, Vec3d lower) : lower_(lower) {
        for (int n = 0; n < 8; ++n)
            values_[static_cast<std::size_t>(n)] =
                find_block(root, {static_cast<int>(index.x) + (n & 4 ? kLeafEdge : 0),
                                  static_cast<int>(index.y) + (n & 2 ? kLeafEdge : 0),
                                  static_cast<int>(index.z) + (n & 1 ? kLeafEdge : 0)});
    }

    /// The field at a local point of the block (clamped into it, for rounding's sake).
    double operator()(Vec3d point) const {
        // Along each axis: the two planes of centres around the point, as the block they lie in,
        // their share of the offset there, and how far the point is from the first.
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

/// Midpoint samples at (k + 1/2) spacing from the start of the ray's way through the grid, so that
/// their places do not depend on the tree. first(t) is monotonic: a sample falls in one segment.
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

/// Within a cell the field along a ray is a cubic, which two Gauss points integrate exactly.
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
        // Constant but for the last layer of cells, which mixes with what lies above the tile.
        const double inside = edge - 1;
        const Segment middle = clip(ray, lower, lower + Vec3d{inside, inside, inside}, segment);
        if (middle.empty()) return blocks(lower, edge, segment);
        sum += rule.constant(value, middle);
        blocks(lower, edge, {segment.first, middle.first});
        blocks(lower, edge, {middle.last, segment.last});
    }

    /// Every block of a tile that the segment crosses.
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
        march(grid.tree.root(), grid.corner, ray, linear, within);
        return linear.sum;
    };
    const double step = grid.options.step_voxels;
    if (step == 0) return integrate(GaussPoints{});

    // Whole steps from where the ray enters the box of the grid, or the segment, to where it
    // leaves.
    const auto& box = grid.tree.root().bbox();
    const Vec3d size{double(box.dim()[0]), double(box.dim()[1]), double(box.dim()[2])};
    const Segment whole = clip(ray, {0, 0, 0}, size, within);
    if (whole.empty()) return 0;
    const double way = whole.last - whole.first;
    const double steps = std::ceil(way * length(ray.direction) / step);
    return integrate(Midpoints{whole.first, way / steps});
}

}  // namespace vog::reference
