// splat_kernels.h: the two inner loops of the splat renderer, projection and rows, compiled once
// for every SIMD target (Highway) and chosen at run time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/kernel_polynomial.h"
#include "vog/camera.h"
#include "vog/gaussians.h"

namespace vog {

/// Pixels whose centres the projected support may cover, inclusive; inside the image.
struct PixelBounds {
    std::int32_t x0 = 0, x1 = -1, y0 = 0, y1 = -1;
    bool empty() const { return x1 < x0 || y1 < y0; }
};

/// A Gaussian wholly in front of the eye plane. With (x, y) the pixel's offset from the projected
/// mean and d the whitened direction through the pixel, scaled so that |d| = 1 at the mean:
///   m² C = (ax x + ay y)² + (by y)²                      the squared cross product e x d
///   C    = (c0 + cx x + cy y)² + (d0 + dy y)² + e0²      the squared length of d
/// Both are sums of squares by a triangular change of basis: no cancellation, however elongated the
/// Gaussian or far the eye. tau = weight |D| sqrt(2u / C) · KernelPolynomial, u = (k² - m²)/2, with
/// |D| the length of the pixel's direction whose forward component is 1.
struct FarSplat {
    PixelBounds bounds;
    std::int32_t column = 0,
                 row = 0;  ///< the pixel nearest the projected mean, maybe off the image
    float offset_x = 0, offset_y = 0;  ///< projected mean minus that pixel, in [-1/2, 1/2]
    float ax = 0, ay = 0, by2 = 0;     ///< by2 = by²
    float c0 = 0, cx = 0, cy = 0, d0 = 0, dy = 0, e02 = 0;  ///< e02 = e0²
    float weight = 0;
};

/// A Gaussian around, beside or partly behind the eye: the exact segment form, in double precision.
struct NearSplat {
    PixelBounds bounds;
    Vec3d e;                       ///< whitened eye -> mean
    Vec3d corner, step_x, step_y;  ///< whitened directions of CameraFrame
    double density = 0;
};

/// Splats in the order of their Gaussians; those behind the eye, outside the image or between pixel
/// centres are left out.
struct Splats {
    std::vector<FarSplat> far;
    std::vector<NearSplat> near;
};

inline constexpr int kTileWidth = 32, kTileHeight = 16;  ///< pixels of a tile

/// One tile's pixels: T so far, and what depends on the pixel alone.
struct TilePixels {
    /// Rows are padded so that a vector may start at any of their pixels.
    static constexpr int kMaxLanes = 16, kStride = kTileWidth + kMaxLanes;
    std::int32_t column = 0, row = 0;                ///< of the first pixel
    alignas(64) float depth[kTileHeight][kStride];   ///< T
    alignas(64) float slant2[kTileHeight][kStride];  ///< |D|²
};

/// The loops for one SIMD target.
struct SplatKernels {
    std::int64_t target = 0;  ///< Highway's target bit; 0: one lane, no SIMD
    /// Projects Gaussians first ... last - 1, appending to `splats`.
    void (*project)(const Gaussians& gaussians, std::size_t first, std::size_t last,
                    const CameraFrame& frame, Splats& splats);
    /// Adds splats[index[0]] ... splats[index[count - 1]] to the rows of `tile` they touch.
    void (*add_far)(const FarSplat* splats, const std::uint32_t* index, std::size_t count,
                    const KernelPolynomial& kernel, TilePixels& tile);
};

/// The best target this machine can run.
const SplatKernels& best_splat_kernels();
/// One of splat_targets(). throws vog::Error listing the names if there is none such
const SplatKernels& splat_kernels(const std::string& target_name);

}  // namespace vog
