// near_splats.h: Splats that may contain the eye, drawn by the exact integral over a segment.
#pragma once

#include <algorithm>

#include "render/ray_gaussian.h"
#include "render/splat/splat_kernels.h"

namespace vog::splat {

/// Gaussian i over the whole image.
/// w      its whitening
/// frame  relative to Gaussians::origin
inline NearSplat near_splat(const SplatModel& model, std::size_t i, const CameraFrame& frame,
                            const Mat3& w) {
    NearSplat s;
    s.bounds.x1 = static_cast<std::uint16_t>(frame.width - 1);
    s.bounds.y1 = static_cast<std::uint16_t>(frame.height - 1);
    s.e = w * (vec_cast<double>(model.gaussians->mean[i]) - frame.first_origin);
    s.shift_x = w * (-frame.shift_x);
    s.shift_y = w * (-frame.shift_y);
    s.corner = w * frame.corner;
    s.step_x = w * frame.step_x;
    s.step_y = w * frame.step_y;
    s.density = double{model.gaussians->density[i]} / model.unit;
    s.index = i;
    return s;
}

/// Adds T / |D| of one near splat to the pixels of a tile; the segment is clipped at the eye. |D| is
/// the length of the pixel's direction whose forward component is 1.
inline void add_near(const NearSplat& s, double cutoff, TilePixels& tile) {
    const int y0 = std::max(s.bounds.y0 - tile.row, 0), x0 = std::max(s.bounds.x0 - tile.column, 0);
    const int y1 = std::min(s.bounds.y1 - tile.row, kTileHeight - 1);
    const int x1 = std::min(s.bounds.x1 - tile.column, kTileWidth - 1);
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const double column = tile.column + x, row = tile.row + y;
            const Vec3d e = s.e + column * s.shift_x + row * s.shift_y;
            const Vec3d d = s.corner + column * s.step_x + row * s.step_y;
            tile.depth[y][x] += static_cast<float>(s.density * segment_integral(e, d, cutoff));
        }
}

}  // namespace vog::splat
