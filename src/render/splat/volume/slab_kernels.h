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

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
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

inline constexpr int kMostSlabs = 1024;
/// Transmittance that hides everything behind.
inline constexpr float kDarkTransmittance = 1e-6f;

/// Pixels of a tile that are summed and composited at once: the slabs that a splat meets fit a core's first cache.
/// Smoke under a ramp, 1024 x 1024: 60 ms; 8 x 4 pixels 93 ms, most of it loading coefficients of splats; 64 x 16 80 ms.
inline constexpr int kCellWidth = 16, kCellHeight = 16, kCellPixels = kCellWidth * kCellHeight;
inline constexpr int kCellColumns = kTileWidth / kCellWidth, kCellRows = kTileHeight / kCellHeight;

/// Numbers of the pixels of a cell, rows from the top.
using CellPixels = std::array<float, kCellPixels>;

/// Sums of light / |D| in one slab of a cell.
struct alignas(64) SlabSums {
    std::array<CellPixels, 4> channel{};
};

/// Sums over the slabs of a cell, and colours composited of them.
struct SlabCell {
    std::int32_t column = 0, row = 0;  ///< image position of the first pixel
    float first = 0, thickness = 1;    ///< depth of the first slab's front, and from slab to slab
    float most_share = 0;              ///< of maximum_cell: most_share_per_density
    /// Whether rays are clipped, and between which depths.
    bool clipped = false;
    alignas(64) CellPixels clip_near{}, clip_far{};
    std::vector<SlabSums> sums;                    ///< [slabs] all 0 between cells
    int lowest = kMostSlabs, highest = -1;         ///< slabs that splats may have added to
    alignas(64) std::array<CellPixels, 4> seen{};  ///< premultiplied colour, transmittance

    int slabs() const { return static_cast<int>(sums.size()); }
    int slab_at(float depth) const {
        return static_cast<int>(
            std::clamp((depth - first) / thickness, 0.0f, static_cast<float>(slabs() - 1)));
    }
    bool touched() const { return lowest <= highest; }
    void touch(int from, int to) {
        lowest = std::min(lowest, from);
        highest = std::max(highest, to);
    }
    /// Sets all sums to 0.
    void clear() {
        if (touched())
            std::memset(static_cast<void*>(&sums[static_cast<std::size_t>(lowest)]), 0,
                        sizeof(SlabSums) * static_cast<std::size_t>(highest - lowest + 1));
        lowest = kMostSlabs, highest = -1;
    }
};

/// A splat with pixels in a cell, and the slabs that it meets.
struct CellSplat {
    std::uint32_t splat = 0;
    std::uint16_t first = 0, last = 0;
};
/// Those of one batch, by first slab.
struct CellRun {
    const FarSplat* far = nullptr;
    const SlabSplat* lights = nullptr;
    std::span<const CellSplat> splats;
};
/// Those of a picture.
struct CellSplats {
    std::span<CellRun> runs;
    const SlabPolynomials& polynomials;
    const CameraFrame& frame;
};

/// The loops for one SIMD target.
struct SlabKernels {
    /// Adds all splats.
    void (*sum)(const CellSplats& splats, SlabCell& cell);
    /// Adds the splats that begin in a slab, composites the slab, and goes on to the next, as long as one of the
    /// pixels is not dark. Empties the runs; sums behind the last slab stay.
    void (*draw)(const CellSplats& splats, SlabCell& cell);
    /// Composites sums.
    void (*composite)(const CameraFrame& frame, SlabCell& cell);
};
/// Those of the same target as `kernels`.
const SlabKernels& slab_kernels(const SplatKernels& kernels);

}  // namespace vog::splat
