// box_view.h: Voxels of a grid as boxes on the pixels of an orthographic camera. Sums along rays need no order: where
// a voxel covers several pixels, to add it to all of them is faster than a walk from voxel to voxel on each ray.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "render/pixel_tiles.h"
#include "render/reference/fields/box_kernels.h"
#include "render/reference/fields/field_grid.h"
#include "render/reference/fields/field_moments.h"
#include "vog/camera.h"

namespace vog::reference {

/// Voxels of constant value for boxes alone, without a field.
class DepthGrid {
  public:
    /// The grid must outlive this.
    explicit DepthGrid(const VoxelGrid::Data& grid) : grid_(grid) {}
    const VoxelGrid::Data& data() const { return grid_; }

    /// As FieldGrid::LeafCells; the field is 0.
    class LeafCells {
      public:
        explicit LeafCells(const NanoLeaf& leaf) : leaf_(*leaf.data()) {}
        unsigned active(int x, int y) const {
            unsigned bits = 0;
            for (int z = 0; z < kLeafEdge; ++z) {
                const auto offset = static_cast<std::uint32_t>(leaf_offset(x, y, z));
                bits |= unsigned{leaf_.mValueMask.isOn(offset)} << z;
            }
            return bits;
        }
        double density(int offset) const { return double{leaf_.mValues[offset]}; }
        double value(int) const { return 0; }

      private:
        const NanoLeaf::DataType& leaf_;
    };
    /// As FieldGrid's.
    template <class Near, class Visitor>
    void search_boxes(Vec3d, const Near& near, Visitor& visitor) const {
        search(grid_.root_cells, near, Search<Visitor>{visitor});
    }

  private:
    template <class Visitor>
    struct Search {
        Visitor& visitor;
        void leaf(const NanoLeaf& leaf, Vec3d lower) { visitor.leaf(LeafCells(leaf), lower); }
        void tile(Vec3d lower, double edge, float value) {
            visitor.tile(lower, edge, double{value}, 0);
        }
    };
    const VoxelGrid::Data& grid_;
};

/// A grid under parallel rays. The grid must outlive the view.
/// Grid  FieldGrid or DepthGrid
template <class Grid>
class BoxView {
  public:
    /// frame  of an orthographic camera
    BoxView(const Grid& grid, const CameraFrame& frame);

    /// Whether add_to is faster than a walk along each ray: voxels cover at least two pixels, and are no slivers.
    bool faster_than_rays() const;
    /// Adds the grid to a tile of pixels, the first of them (column, row) of the picture.
    void add_to(BoxTile& tile, int column, int row) const;

  private:
    class TileSearch;
    /// Pixel coordinates that a box may cover, or their differences from those of its lower corner.
    struct Range {
        double x0, x1, y0, y1;
    };
    /// Differences for a box of this size, voxels.
    Range extent(Vec3d size) const;
    void set_shifts(BoxTile& tile, int column, int row) const;

    const Grid& grid_;
    CameraFrame frame_;
    Vec3d direction_;        ///< of the rays, world
    Vec3d inverse_;          ///< t per voxel along an axis
    Vec3d step_x_, step_y_;  ///< pixels per voxel along an axis
    double x_ = 0, y_ = 0;   ///< pixel coordinates of the local origin
    double slack_ = 0;       ///< pixels, beyond the rounding of coordinates
};

/// Grids of a picture by the way that their voxels are added. The grids must outlive them.
template <class Grid>
struct DividedGrids {
    std::vector<BoxView<Grid>> boxes;
    std::vector<const Grid*> rays;

    DividedGrids(std::span<const Grid> grids, const CameraFrame& frame,
                 const ReferenceOptions& options) {
        const bool parallel = frame.orthographic && options.samples == 1 && options.clip.empty();
        for (const Grid& grid : grids) {
            if (parallel) {
                const BoxView<Grid> view(grid, frame);
                if (view.faster_than_rays()) {
                    boxes.push_back(view);
                    continue;
                }
            }
            rays.push_back(&grid);
        }
    }

    /// Sums over one ray a pixel of some rows.
    /// add_ray  called with a grid of `rays`, a ray and the sums that receive it
    /// take     called with the column and row of each pixel and its sums; both in parallel
    template <class AddRay, class Take>
    void for_each_pixel(const CameraFrame& frame, int first_row, int height,
                        const Progress& progress, const AddRay& add_ray, const Take& take) const {
        const auto draw = [&](int left, int below) {
            const int top = first_row + below;
            const auto tile = std::make_unique<BoxTile>();
            for (const BoxView<Grid>& view : boxes) view.add_to(*tile, left, top);
            const int columns = std::min(BoxTile::kWidth, frame.width - left);
            const int rows_here = std::min(BoxTile::kHeight, first_row + height - top);
            for (int y = 0; y < rows_here; ++y)
                for (int x = 0; x < columns; ++x) {
                    check_interrupt();
                    const double column = tile->column[y][x];
                    FirstRelative pixel{{{column, tile->first[y][x], tile->second[y][x]},
                                         tile->reference[y][x],
                                         column > 0}};
                    for (const Grid* grid : rays)
                        add_ray(*grid, frame.origin(left + x, top + y),
                                frame.direction(left + x, top + y), pixel);
                    take(left + x, top + y, pixel);
                }
            return true;
        };
        for_each_tile({frame.width, height, BoxTile::kWidth, BoxTile::kHeight}, progress, draw,
                      [](bool) {});
    }
};

}  // namespace vog::reference
