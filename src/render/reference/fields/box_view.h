// box_view.h: Voxels of a grid as boxes on the pixels of an orthographic camera. Sums along rays need no order: where
// a voxel covers several pixels, to add it to all of them is faster than a walk from voxel to voxel on each ray.
#pragma once

#include "render/reference/fields/box_kernels.h"
#include "render/reference/fields/field_grid.h"
#include "vog/camera.h"

namespace vog::reference {

/// A grid under parallel rays. The grid must outlive the view.
class BoxView {
  public:
    /// frame  of an orthographic camera
    BoxView(const FieldGrid& grid, const CameraFrame& frame);

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

    const FieldGrid& grid_;
    CameraFrame frame_;
    Vec3d direction_;        ///< of the rays, world
    Vec3d inverse_;          ///< t per voxel along an axis
    Vec3d step_x_, step_y_;  ///< pixels per voxel along an axis
    double x_ = 0, y_ = 0;   ///< pixel coordinates of the local origin
    double slack_ = 0;       ///< pixels, beyond the rounding of coordinates
};

}  // namespace vog::reference
