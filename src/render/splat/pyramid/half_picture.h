// half_picture.h: Pictures at half their resolution, whose pixels are every second one of every second row, and what lies
// between these: by cubic interpolation where neighbours agree with one another, drawn elsewhere.
#pragma once

#include <cstdint>
#include <vector>

#include "render/by_value/volume_image.h"
#include "render/splat/volume/slab_kernels.h"
#include "vog/camera.h"

namespace vog::splat {

/// Rays of a picture at half the resolution: pixel (i, j) is pixel 2 (i - kHalfMargin), 2 (j - kHalfMargin) of the whole
/// one.
inline constexpr int kHalfMargin = 1;
CameraFrame half_frame(const CameraFrame& frame);

/// Rows of the cells of a picture.
class CellRows {
  public:
    CellRows(int width, int height);
    /// Rows of the cell whose first pixel this is, a bit each, the lowest at the top.
    std::uint32_t& of(int column, int row) {
        return rows_[static_cast<std::size_t>(row / kCellHeight) * columns_ +
                     static_cast<std::size_t>(column / kCellWidth)];
    }
    std::uint32_t of(int column, int row) const {
        return const_cast<CellRows*>(this)->of(column, row);
    }

  private:
    std::size_t columns_;
    std::vector<std::uint32_t> rows_;
};

/// Fills a picture of this size from one at half its resolution.
/// precision  error of a pixel, in colour and opacity from 0 to 1, from which it has to be drawn: estimated from fourth
///            differences of its neighbours
/// returns    rows that have to be drawn
CellRows fill_from_half(const VolumeImage& half, double precision, VolumeImage& picture);

/// Least half axis of the ellipse that a splat covers, pixels.
float least_half_axis(const FarSplat& splat);
/// Splats narrower than this may lie between the pixels at half the resolution, pixels.
inline constexpr float kLeastHalfAxis = 1.6f;
/// Splats wider than this are mostly smooth at half the resolution, pixels. At 4, a picture of 130,000 at 512 x 512 took 1.3 times
/// as long as with every pixel drawn: most of its rows were drawn at each resolution.
inline constexpr float kWideHalfAxis = 8;

}  // namespace vog::splat
