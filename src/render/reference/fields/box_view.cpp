// box_view.cpp: Search of a grid for the voxels on a tile of pixels.
#include "render/reference/fields/box_view.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "render/reference/reference.h"

namespace vog::reference {

namespace {

// Stands for the inverse of a direction 0. t of faces is then (c - o) 2^900: below 0 before the ray, above behind
// it, and 0 in the face itself, so that with t >= 0 a ray in a face is in the box above it alone. Exact: the
// factor is a power of two, and coordinates are below 2^33.
constexpr double kNeverCrossed = 0x1p900;

/// Least integer not below x, x >= 0; without SSE4.1 std::ceil is a call.
int ceiling(double x) {
    const int whole = static_cast<int>(x);
    return whole + (whole < x);
}

}  // namespace

template <class Grid>
BoxView<Grid>::BoxView(const Grid& grid, const CameraFrame& frame)
    : grid_(grid), frame_(frame), direction_(frame.direction(0, 0)) {
    const VoxelGrid::Data& data = grid.data();
    const GridRay ray = data.voxel_ray(frame.origin(0, 0), direction_);
    const Mat3 world_from_local = inverse(data.local_from_world);
    // A world point p is at column (p - first_origin) . shift_x / |shift_x|^2.
    const Vec3d per_column = (1 / dot(frame.shift_x, frame.shift_x)) * frame.shift_x;
    const Vec3d per_row = (1 / dot(frame.shift_y, frame.shift_y)) * frame.shift_y;
    double reach = 0;
    for (int axis = 0; axis < 3; ++axis) {
        inverse_[axis] = ray.direction[axis] == 0 ? kNeverCrossed : ray.inverse[axis];
        const Vec3d voxel = world_from_local.column(axis);
        step_x_[axis] = dot(voxel, per_column);
        step_y_[axis] = dot(voxel, per_row);
        reach +=
            std::abs(ray.origin[axis]) * std::max(std::abs(step_x_[axis]), std::abs(step_y_[axis]));
    }
    x_ = -dot(ray.origin, step_x_);
    y_ = -dot(ray.origin, step_y_);
    slack_ = 0.01 + 0x1p-44 * reach;
}

template <class Grid>
bool BoxView<Grid>::faster_than_rays() const {
    // Boxes and rays are equally fast near 1.5 pixels a voxel (docs/performance.md, "Maps beside yt's projections").
    constexpr double kLeastPixels = 2;
    // The kernel adds a voxel to its rectangle of pixels, at a tenth of the walk's cost for each.
    constexpr double kMostWaste = 10;
    // A parallelepiped covers the parallelograms of its three edges, two by two.
    const auto parallelogram = [&](int a, int b) {
        return std::abs(step_x_[a] * step_y_[b] - step_x_[b] * step_y_[a]);
    };
    const double covered = parallelogram(0, 1) + parallelogram(1, 2) + parallelogram(2, 0);
    double width = 0, height = 0;
    for (int axis = 0; axis < 3; ++axis)
        width += std::abs(step_x_[axis]), height += std::abs(step_y_[axis]);
    return covered >= kLeastPixels && width * height < kMostWaste * covered;
}

template <class Grid>
typename BoxView<Grid>::Range BoxView<Grid>::extent(Vec3d size) const {
    Range range{-slack_, slack_, -slack_, slack_};
    for (int axis = 0; axis < 3; ++axis) {
        const double dx = size[axis] * step_x_[axis], dy = size[axis] * step_y_[axis];
        range.x0 += std::min(dx, 0.0), range.x1 += std::max(dx, 0.0);
        range.y0 += std::min(dy, 0.0), range.y1 += std::max(dy, 0.0);
    }
    return range;
}

template <class Grid>
void BoxView<Grid>::set_shifts(BoxTile& tile, int column, int row) const {
    for (int y = 0; y < BoxTile::kHeight; ++y)
        for (int x = 0; x < BoxTile::kWidth; ++x) {
            // The origin as the walk has it: both agree on rays in a face.
            const Vec3d origin = grid_.data().voxel_origin(frame_.origin(column + x, row + y));
            for (int axis = 0; axis < 3; ++axis)
                tile.shift[axis][y][x] = -origin[axis] * inverse_[axis];
        }
}

/// Visitor of the nodes on one tile of pixels: collects their voxels for the kernel.
template <class Grid>
class BoxView<Grid>::TileSearch {
  public:
    TileSearch(const BoxView& view, BoxTile& tile, int column, int row)
        : view_(view),
          tile_(tile),
          column_(column),
          row_(row),
          x_(view.x_ - column),
          y_(view.y_ - row),
          stretch_(length(view.direction_)),
          slab_(view.extent({1, kLeafEdge, kLeafEdge})),
          line_(view.extent({1, 1, kLeafEdge})),
          voxel_(view.extent({1, 1, 1})) {}

    bool near(Vec3d lower, Vec3d size) const { return on_tile(at(lower), view_.extent(size)); }
    void leaf(const typename Grid::LeafCells& cells, Vec3d lower) {
        for (int x = 0; x < kLeafEdge; ++x) {
            if (!on_tile(at(lower + Vec3d{double(x), 0, 0}), slab_)) continue;
            for (int y = 0; y < kLeafEdge; ++y) {
                const Vec3d first = lower + Vec3d{double(x), double(y), 0};
                const unsigned active = cells.active(x, y);
                if (active == 0 || !on_tile(at(first), line_)) continue;
                for (int z = 0; z < kLeafEdge; ++z) {
                    const Vec3d voxel = first + Vec3d{0, 0, double(z)};
                    const Pixel pixel = at(voxel);
                    if (!(active >> z & 1) || !on_tile(pixel, voxel_)) continue;
                    const int offset = leaf_offset(x, y, z);
                    add(voxel, 1, pixel, voxel_, cells.density(offset), cells.value(offset));
                }
            }
        }
    }
    void tile(Vec3d lower, double edge, double density, double value) {
        add(lower, edge, at(lower), view_.extent({edge, edge, edge}), density, value);
    }
    void flush() {
        if (count_ == 0) return;
        if (!shifted_) view_.set_shifts(tile_, column_, row_);
        shifted_ = true;
        check_interrupt();
        add_boxes(boxes_, count_, tile_);
        count_ = 0;
    }

  private:
    static constexpr double kRight = BoxTile::kWidth - 1, kBottom = BoxTile::kHeight - 1;
    static constexpr std::size_t kBatch = 64;

    /// Coordinates in the tile.
    struct Pixel {
        double x, y;
    };
    Pixel at(Vec3d lower) const {
        return {x_ + dot(lower, view_.step_x_), y_ + dot(lower, view_.step_y_)};
    }
    static bool on_tile(Pixel at, const Range& extent) {
        return at.x + extent.x1 >= 0 && at.x + extent.x0 <= kRight && at.y + extent.y1 >= 0 &&
               at.y + extent.y0 <= kBottom;
    }
    /// Adds a box on the tile.
    void add(Vec3d lower, double edge, Pixel at, const Range& extent, double density,
             double value) {
        if (!(density > 0)) return;
        PixelBox& box = boxes_[count_];
        for (int axis = 0; axis < 3; ++axis) {
            const double inverse = view_.inverse_[axis];
            const double low = lower[axis], high = low + edge;
            box.enter[axis] = (inverse > 0 ? low : high) * inverse;
            box.leave[axis] = (inverse > 0 ? high : low) * inverse;
        }
        box.weight = density * stretch_;
        box.value = value;
        box.x0 = ceiling(std::max(at.x + extent.x0, 0.0));
        box.x1 = static_cast<int>(std::min(at.x + extent.x1, kRight));
        box.y0 = ceiling(std::max(at.y + extent.y0, 0.0));
        box.y1 = static_cast<int>(std::min(at.y + extent.y1, kBottom));
        if (++count_ == kBatch) flush();
    }

    const BoxView& view_;
    BoxTile& tile_;
    int column_, row_;           ///< of the tile in the picture
    double x_, y_;               ///< coordinates in the tile of the local origin
    double stretch_;             ///< world units per t
    Range slab_, line_, voxel_;  ///< extents of an eighth of a leaf, a row of it along z, a voxel
    PixelBox boxes_[kBatch];
    std::size_t count_ = 0;
    bool shifted_ = false;  ///< whether the tile has the grid's shifts
};

template <class Grid>
void BoxView<Grid>::add_to(BoxTile& tile, int column, int row) const {
    TileSearch on_tile(*this, tile, column, row);
    const auto near = [&](Vec3d lower, Vec3d size) { return on_tile.near(lower, size); };
    grid_.search_boxes(direction_, near, on_tile);
    on_tile.flush();
}

template class BoxView<FieldGrid>;
template class BoxView<DepthGrid>;

}  // namespace vog::reference
