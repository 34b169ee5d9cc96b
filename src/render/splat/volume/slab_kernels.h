// slab_kernels.h: Inner loops of volume rendering by splatting: sums of moments of a field over depth slabs, and their
// classification and compositing, compiled for every SIMD target by Highway.
//
// Along the ray of a pixel, with t the depth along the view and D the direction of forward component 1, a Gaussian is
// a normal distribution about t* with deviation 1 / |W D|, cut at u = ±sqrt(k² - m²) deviations. The part of its
// integral between u0 and u1 is
//   tau = e^{-m²/2} / |W D| (G(u1) - G(u0)),   G(u) = integral from 0 to u of e^{-s²/2} ds
// times the density, and |D|, which is left to the end. The field is linear along the ray: phi is its value in the
// middle of the part, a share of its range. Channels of a slab are the sums of device/value_moments.h:
//   tau,  tau phi,  tau (phi² + r²),  tau (phi³ + 3 phi r² + third),  and for light tau g, g along right, down, forward
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "render/by_value/slab_moments.h"
#include "render/chebyshev_fit.h"
#include "render/device/light/shading.h"
#include "render/splat/splat_kernels.h"
#include "vog/image.h"

namespace vog::splat {

using enum device::ValueChannel;
using device::kDarkTransmittance, device::kLitChannels, device::kMaximumChannels,
    device::kUnlitChannels;

/// A field along the pixels of a FarSplat, as shares of its range. Depths are relative to that of the picture's SlabView.
struct SlabSplat {
    float mean_x = 0, mean_y = 0;    ///< projected mean, from (column, row)
    float depth = 0;                 ///< of the mean
    float forward = 0;               ///< the same from the eye: t0
    float depth_x = 0, depth_y = 0;  ///< parallel rays: change of t* a pixel
    /// Deviation along a ray of forward component 1, 1 / |W D|, times sqrt(C), C that of FarSplat.
    float per_root = 0;
    /// v, P = x x + y y and A of field_kernels.h; of parallel rays phi at t* and its change with depth.
    float value = 0, x = 0, y = 0, along = 0;
    float variance = 0, third = 0;  ///< central moments about the plane
    float gradient[3] = {};         ///< right, down, forward, per SlabView::length
    float near = 0, far = 0;        ///< range of depths of the whole support
};

/// Of a cutoff: G(u) / u in u², and e^{(x - k²)/2} in x = k² - m².
struct SlabPolynomials {
    ChebyshevFit part, peak;
};
/// cutoff     k, (0, 8]
/// tolerance  of the whole integral of a Gaussian through its mean, about
SlabPolynomials fit_slab_polynomials(double cutoff, double tolerance = 1e-5);

inline constexpr int kMostSlabs = 1024;

/// Pixels of a tile that are summed and composited at once: the slabs that a splat meets fit a core's first cache.
/// Smoke under a ramp, 1024 x 1024: 60 ms; 8 x 4 pixels 93 ms, most of it loading coefficients of splats; 64 x 16 80 ms.
inline constexpr int kCellWidth = 16, kCellHeight = 16, kCellPixels = kCellWidth * kCellHeight;
inline constexpr int kCellColumns = kTileWidth / kCellWidth, kCellRows = kTileHeight / kCellHeight;

/// Rows of a cell, a bit each.
inline constexpr std::uint32_t kAllRows = (std::uint32_t{1} << kCellHeight) - 1;

/// Numbers of the pixels of a cell, rows from the top.
using CellPixels = std::array<float, kCellPixels>;

/// One channel of one slab.
struct alignas(64) SlabPlane {
    CellPixels pixel{};
};

/// Division of a picture's depths, the same for all its tiles: no seams.
struct SlabDepths {
    float first = 0, thickness = 1;  ///< depth of the first slab's front, and from slab to slab
};

/// Sums over the slabs of a cell, and colours composited of them.
struct SlabCell {
    std::int32_t column = 0, row = 0;  ///< image position of the first pixel
    SlabDepths depths;
    int slabs = 1, channels = kUnlitChannels;
    std::uint32_t rows = kAllRows;  ///< that are drawn, a bit each, the lowest at the top
    /// Whether rays are clipped, and between which depths.
    bool clipped = false;
    alignas(64) CellPixels clip_near{}, clip_far{};
    std::vector<SlabPlane> planes;                 ///< [slabs][channels] all 0 between cells
    int lowest = kMostSlabs, highest = -1;         ///< slabs that splats may have added to
    alignas(64) std::array<CellPixels, 4> seen{};  ///< premultiplied colour, transmittance

    void resize(int of_slabs, int of_channels) {
        slabs = of_slabs, channels = of_channels;
        planes.resize(static_cast<std::size_t>(slabs) * static_cast<std::size_t>(channels));
    }
    /// Channel 0 of a slab; the others follow.
    SlabPlane* slab(int n) { return planes.data() + static_cast<std::ptrdiff_t>(n) * channels; }
    const SlabPlane* slab(int n) const { return const_cast<SlabCell*>(this)->slab(n); }
    int slab_at(float depth) const {
        return static_cast<int>(std::clamp((depth - depths.first) / depths.thickness, 0.0f,
                                           static_cast<float>(slabs - 1)));
    }
    bool draws(std::size_t n) const { return (rows >> n & 1) != 0; }
    bool touched() const { return lowest <= highest; }
    void touch(int from, int to) {
        lowest = std::min(lowest, from);
        highest = std::max(highest, to);
    }
    /// Sets the sums of slabs from ... to to 0.
    void clear(int from, int to) {
        if (from <= to)
            std::memset(static_cast<void*>(slab(from)), 0,
                        sizeof(SlabPlane) * static_cast<std::size_t>((to - from + 1) * channels));
    }
    /// Sets all sums to 0.
    void clear() {
        clear(lowest, highest);
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
    const SlabSplat* fields = nullptr;
    std::span<const CellSplat> splats;
};
/// Those of a picture.
struct CellSplats {
    std::span<CellRun> runs;
    const SlabPolynomials& polynomials;
    const CameraFrame& frame;
};

/// What makes light of the sums of a picture.
struct SlabLight {
    const CameraFrame& frame;
    device::MeanLight light;  ///< times SplatModel::unit
    device::BlinnPhong look;  ///< its light along right, down, forward
    device::LightLattice lattice{};
    /// Place in the lattice, in cells: of depth 0 of SlabDepths on the axis of the view, and its change by a world unit along
    /// right, down and forward.
    device::Float3 middle{}, right{}, down{}, forward{};
    float depth = 0;                  ///< of depth 0 of SlabDepths, from the eye, world units
    float dark = kDarkTransmittance;  ///< transmittance that hides everything behind
};

/// A layer in a cell of a picture: sums of a model and what makes light of them, or optical depths and colours times them.
struct LayerCell {
    SlabCell* cell = nullptr;
    const SlabLight* light = nullptr;  ///< null: channels are red, green, blue and tau
};

/// A surface in a slab of a pixel.
struct SlabSurface {
    int slab;
    std::uint32_t pixel;  ///< of the cell
    float share;          ///< of the slab that lies in front of it
    std::array<float, 4>
        front;  ///< what else lies between it and the one before: colour times tau, tau
    std::array<float, 3> color;
    float opacity;
};

/// The loops for one SIMD target.
struct SlabKernels {
    /// Adds all splats.
    void (*sum)(const CellSplats& splats, SlabCell& cell);
    /// Adds the splats that begin in a slab, composites the one before, and goes on to the next, as long as one of
    /// the pixels is not dark. Empties the runs; sums behind the last slab stay.
    void (*draw)(const CellSplats& splats, const SlabLight& light, SlabCell& cell);
    /// Composites sums.
    void (*composite)(const SlabLight& light, SlabCell& cell);
    /// Largest mean over slabs: red, a share of the field's range, with alpha 1 where there is one.
    /// most_share  of the field's range per unit of kTau in a slab
    void (*maximum)(float most_share, SlabCell& cell);
    /// Composites cells of one place under the same depths, and surfaces between. In front of a surface lies its share of a model's slab,
    /// which is even along the ray.
    /// surfaces  sorted by slab, then by pixel, then by share
    /// seen      receives premultiplied colour and transmittance
    void (*composite_layers)(std::span<const LayerCell> layers,
                             std::span<const SlabSurface> surfaces,
                             std::array<CellPixels, 4>& seen);
};
/// Those of the same target as `kernels`.
const SlabKernels& slab_kernels(const SplatKernels& kernels);

}  // namespace vog::splat
