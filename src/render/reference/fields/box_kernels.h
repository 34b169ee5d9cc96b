// box_kernels.h: Sums of voxels over the pixels of a tile under parallel rays, compiled for every SIMD target and
// chosen at run time (Highway). Without fused multiplications, so that all targets give the same bytes.
#pragma once

#include <cstddef>

namespace vog::reference {

/// Voxel, or constant tile of voxels, on a tile of pixels. A ray crosses the plane at coordinate c along an axis at
///   t = c / d + s,   s = -o / d
/// with o the ray's origin and d its direction in the grid. c / d is the same on all pixels, s in all voxels: a
/// face of two voxels has the same t in both, rounding included, so that no part of a ray is missed or doubled.
struct PixelBox {
    double enter[3], leave[3];           ///< c / d of the faces where rays enter and leave
    double weight = 0;                   ///< density times the rays' length per t, > 0
    double value = 0;                    ///< of the field
    int x0 = 0, x1 = 0, y0 = 0, y1 = 0;  ///< pixels of the tile that may see the voxel, inclusive
};

/// Sums over the pixels of one tile. Columns beyond the width are never read.
struct BoxTile {
    static constexpr int kMaxLanes = 8;
    // Tiles of 32 x 32 were as fast at 800 x 800 pixels and 7 % slower at 1600 x 1600.
    static constexpr int kWidth = 64, kHeight = 32;
    static_assert(kWidth % kMaxLanes == 0);
    using Plane = double[kHeight][kWidth];

    alignas(64) Plane shift[3];   ///< s of a grid
    alignas(64) Plane column;     ///< sum of weight times length
    alignas(64) Plane first;      ///< likewise times the field less its reference
    alignas(64) Plane second;     ///< likewise times its square
    alignas(64) Plane reference;  ///< value of the first voxel on the pixel
};

/// Adds voxels in their order. A pixel has the length of its ray with t >= 0 in each.
void add_boxes(const PixelBox* boxes, std::size_t count, BoxTile& tile);

}  // namespace vog::reference
