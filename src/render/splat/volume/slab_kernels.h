// slab_kernels.h: Inner loops of volume rendering by splatting: sums of light over depth slabs, and their compositing,
// compiled for every SIMD target by Highway.
//
// Along the ray of a pixel, with t the depth along the view and D the direction of forward component 1, a Gaussian is
// a normal distribution about t* with deviation 1 / |W D|, cut at u = ±sqrt(k² - m²) deviations. The part of its
// integral between u0 and u1 is
//   e^{-m²/2} / |W D| (G(u1) - G(u0)),   G(u) = integral from 0 to u of e^{-s²/2} ds
// times the density, and |D|, which is left to the end. The field is linear along the ray: its value in the middle of
// the part gives the light of the whole part by LightQuadratic.
#pragma once

#include <array>
#include <vector>

#include "render/chebyshev_fit.h"
#include "render/splat/splat_kernels.h"
#include "vog/image.h"

namespace vog::splat {

/// Light along the pixels of a FarSplat. Depths are relative to that of the picture's SlabView.
struct SlabSplat {
    float mean_x = 0, mean_y = 0;    ///< projected mean, from (column, row)
    float depth = 0;                 ///< of the mean
    float forward = 0;               ///< the same from the eye: t0
    float depth_x = 0, depth_y = 0;  ///< parallel rays: change of t* a pixel
    /// Deviation along a ray of forward component 1, 1 / |W D|, times sqrt(C), C that of FarSplat.
    float per_root = 0;
    /// z of LightQuadratic: P = x x + y y and A of field_kernels.h; of parallel rays z at t* and its change with depth.
    float x = 0, y = 0, along = 0;
    std::array<std::array<float, 3>, 4> light{};  ///< LightQuadratic::c, in units of the picture
    float near = 0, far = 0;                      ///< range of depths of the whole support
};

/// Of a cutoff: G(u) / u in u², and e^{(x - k²)/2} in x = k² - m².
struct SlabPolynomials {
    ChebyshevFit part, peak;
};
/// cutoff     k, (0, 8]
/// tolerance  of the whole integral of a Gaussian through its mean, about
SlabPolynomials fit_slab_polynomials(double cutoff, double tolerance = 1e-5);

/// Rows of a tile that are summed and composited at once: their slabs fit a core's second cache.
inline constexpr int kBandRows = 16;
inline constexpr int kMostSlabs = 1024;

/// Sums of light / |D| over the pixels of a band of a tile, [slabs][4][rows][kStride].
struct SlabBand {
    static constexpr int kStride = TilePixels::kStride;
    static constexpr int kRows = kBandRows + TilePixels::kMaxRows - 1;
    static constexpr std::size_t kPlane = std::size_t{kRows} * kStride;
    static constexpr TileRange kNone{kTileWidth, -1, kBandRows, -1};

    std::int32_t column = 0, row = 0;  ///< image position of the first pixel
    int slabs = 0;
    float first = 0, thickness = 1;  ///< depth of the first slab's front, and from slab to slab
    float most_share = 0;            ///< of maximum_band: most_share_per_density
    /// Whether rays are clipped, and between which depths: [rows][kStride].
    bool clipped = false;
    std::vector<float> clip_near, clip_far;
    std::vector<float> sums;    ///< all 0 between bands; padding is never read
    std::vector<bool> touched;  ///< [slabs] whether a splat may have added to it
    TileRange pixels = kNone;   ///< touched ones

    static std::size_t offset(int x, int y) {
        return static_cast<std::size_t>(y) * kStride + static_cast<std::size_t>(x);
    }
    void resize(int count) {
        slabs = count;
        touched.assign(static_cast<std::size_t>(count), false);
        sums.resize(std::size_t{4} * kPlane * static_cast<std::size_t>(count));
    }
    int slab_at(float depth) const {
        return static_cast<int>(
            std::clamp((depth - first) / thickness, 0.0f, static_cast<float>(slabs - 1)));
    }
    /// Marks pixels, and the slabs between two depths.
    void touch(const TileRange& range, float near, float far) {
        pixels = {std::min(pixels.x0, range.x0), std::max(pixels.x1, range.x1),
                  std::min(pixels.y0, range.y0), std::max(pixels.y1, range.y1)};
        for (int slab = slab_at(near), last = slab_at(far); slab <= last; ++slab)
            touched[static_cast<std::size_t>(slab)] = true;
    }
    /// Sets all sums to 0; vectors may have added beyond the pixels, in rows and columns.
    void clear() {
        const std::size_t begin = static_cast<std::size_t>(pixels.y0) * kStride;
        const std::size_t end =
            std::min(static_cast<std::size_t>(pixels.y1 + TilePixels::kMaxRows) * kStride, kPlane);
        for (int slab = 0; slab < slabs; ++slab)
            for (int channel = 0; touched[static_cast<std::size_t>(slab)] && channel < 4; ++channel)
                std::fill(plane(slab, channel) + begin, plane(slab, channel) + end, 0.0f);
        pixels = kNone;
        touched.assign(touched.size(), false);
    }
    float* plane(int slab, int channel) {
        return sums.data() + (std::size_t{4} * static_cast<std::size_t>(slab) +
                              static_cast<std::size_t>(channel)) *
                                 kPlane;
    }
};

/// The loops for one SIMD target.
struct SlabKernels {
    using Add = void (*)(const FarSplat* splats, const SlabSplat* lights,
                         const std::uint32_t* index, std::size_t count,
                         const SlabPolynomials& polynomials, SlabBand& band);
    Add add_parallel, add_pinhole;
    /// Composites a band front to back to premultiplied colours, and sets its sums to 0.
    void (*composite)(SlabBand& band, const CameraFrame& frame, Rgba* image);
};
/// Those of the same target as `kernels`.
const SlabKernels& slab_kernels(const SplatKernels& kernels);

}  // namespace vog::splat
