// splat_kernels.h: Inner loops of the splat renderer (projection, rows of pixels, last step of a tile),
// compiled once for every SIMD target by Highway and chosen at run time.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "render/kernel_polynomial.h"
#include "render/pixel_limits.h"
#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/gaussians.h"

namespace vog::splat {

/// Largest width and height of an image, pixels: bounds fit 16 bits.
inline constexpr int kMaxSide = 1 << 16;

/// Bounds of the pixels whose centres a projected support may cover: inclusive, inside the image,
/// never empty.
struct PixelBounds {
    std::uint16_t x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

/// A Gaussian wholly in front of the eye plane; one cache line. With (x, y) the whole pixels from
/// (column, row), the pixel nearest the centre of the projected support, which is an ellipse, and d
/// the whitened direction through the pixel over the peak (in units of SplatModel::unit):
///   C = |d|²         = (cx x + cy y + c0)² + (dy y + d0)² + e02    (parallel rays: e02)
///   F = (k² - m²) C  = f0 - (by y + b0)² - (ax x + ay y + a0)²
/// F is positive exactly on the ellipse. Both are squares of triangular forms around its centre: no
/// cancellation, however elongated the Gaussian or far the eye. The peak a is inside d because
/// sqrt(F) / C then has it as a factor:
///   tau = unit |D| sqrt(F) / C · KernelPolynomial(F / C)
/// with |D| the length of the pixel's direction whose forward component is 1.
struct FarSplat {
    std::int32_t column = 0, row = 0;  ///< may lie outside the image
    float ax = 0, ay = 0, a0 = 0, by = 0, b0 = 0, f0 = 0;
    float cx = 0, cy = 0, c0 = 0, dy = 0, d0 = 0, e02 = 0;
    PixelBounds bounds;
};
static_assert(sizeof(FarSplat) == 64);

/// A Gaussian that the eye or a clip may cut, drawn by the integral over a segment in double precision.
struct NearSplat {
    PixelBounds bounds;
    /// Whitened vector from the ray's origin to the mean at pixel (0, 0), and its change from pixel
    /// to pixel.
    Vec3d e, shift_x, shift_y;
    Vec3d corner, step_x, step_y;  ///< CameraFrame's, whitened
    double density = 0;            ///< peak, in units of SplatModel::unit
    std::size_t index = 0;         ///< of the Gaussian
    bool clipped = false;          ///< whether a clip may cut it
};

/// The Gaussian that a far splat is of.
struct SplatOrigin {
    std::size_t index = 0;
    bool widened = false;  ///< drawn wider than it is
};

/// Gaussians to draw, the radius of their kernels, and the unit of T that keeps the squares of
/// FarSplat inside float's range.
struct SplatModel {
    const Gaussians* gaussians = nullptr;
    double unit = 1;   ///< near the largest T of one Gaussian; a power of two
    float cutoff = 0;  ///< k, standard deviations, in place of Gaussians::cutoff
    PixelLimits limits{};
    const KernelPolynomial* kernel = nullptr;  ///< fit_kernel(cutoff); null if limits.least2 is 0
};

/// Splats of a run of Gaussians, in the same order. Gaussians behind the eye, outside the image,
/// between pixel centres, or with T below 1e-15 units are left out.
struct SplatRun {
    FarSplat* far = nullptr;        ///< room for one per Gaussian
    PixelBounds* bounds = nullptr;  ///< copy of FarSplat::bounds, contiguous, for binning
    std::size_t count = 0;          ///< number of far splats
    std::vector<NearSplat>* near = nullptr;
    SplatOrigin* origin = nullptr;  ///< of the far splats, room as there; null: not needed
};

/// Size of a tile, pixels: the fastest of the sizes tried (docs/performance.md).
inline constexpr int kTileWidth = 64, kTileHeight = 32;

/// Running sum of T / |D| over the pixels of one tile. Padding is never read.
struct TilePixels {
    /// Rows and columns are padded so that a vector of any shape may start at any pixel.
    static constexpr int kMaxLanes = 16, kStride = kTileWidth + kMaxLanes, kMaxRows = 4;
    std::int32_t column = 0, row = 0;  ///< image position of the first pixel
    alignas(64) float depth[kTileHeight + kMaxRows - 1][kStride] = {};
};

/// Parts of a tile's rays that a clip leaves, in units of CameraFrame::direction.
struct TileRays {
    RayInterval kept[kTileHeight][TilePixels::kStride];
};

/// Pixel that the axis of a view goes through, which need not lie in the middle of the picture.
struct AxisPixel {
    double column, row;
};
inline AxisPixel axis_pixel(const CameraFrame& frame) {
    const Vec3d first = frame.orthographic ? frame.first_origin - frame.eye : frame.corner;
    // Halves, quarters or eighths of pixels: no rounding is left.
    constexpr double kParts = 64;
    const auto place = [&](Vec3d axis) {
        return std::round(kParts * frame.pixels_per_unit * dot(first, axis)) / kParts;
    };
    return {-place(frame.right), place(frame.up)};
}

/// Pixels of a tile that a splat touches, inclusive, counted from the tile's first pixel.
struct TileRange {
    int x0, x1, y0, y1;
};
inline TileRange range_in(const TilePixels& tile, const PixelBounds& bounds) {
    return {std::max(bounds.x0 - tile.column, 0), std::min(bounds.x1 - tile.column, kTileWidth - 1),
            std::max(bounds.y0 - tile.row, 0), std::min(bounds.y1 - tile.row, kTileHeight - 1)};
}

/// The loops for one SIMD target.
struct SplatKernels {
    std::int64_t target = 0;  ///< Highway's target bit; 0: one lane, no SIMD
    /// Projects Gaussians first ... last - 1 to run.far[run.count] and on; near ones are appended.
    /// The frame is relative to Gaussians::origin.
    void (*project)(const SplatModel& model, const CameraFrame& frame, std::size_t first,
                    std::size_t last, SplatRun& run);
    /// Adds splats[index[0]] ... splats[index[count - 1]] to the pixels of `tile` they touch.
    void (*add_far)(const FarSplat* splats, const std::uint32_t* index, std::size_t count,
                    const KernelPolynomial& kernel, TilePixels& tile);
    /// Adds a near splat: the integral of its kernel, cut at k, over the part of each ray before the eye that stays.
    /// rays  of the tile; unused unless the splat is clipped
    void (*add_near)(const NearSplat& splat, double cutoff, const TileRays& rays, TilePixels& tile);
    /// Writes T = depth |D| unit of a tile's pixels to the rows of an image, or adds it if `add`.
    /// Sets the tile's pixels to 0 for the next tile, while they are in the cache.
    void (*finish_tile)(TilePixels& tile, const CameraFrame& frame, double unit, bool add,
                        float* image);
};

/// The widest target that this machine can run.
const SplatKernels& best_splat_kernels();
/// The target of this name, one of splat_targets(). throws vog::Error listing the names
const SplatKernels& splat_kernels(const std::string& target_name);

}  // namespace vog::splat
