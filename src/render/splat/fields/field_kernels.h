// field_kernels.h: Inner loops of the splat renderer for fields: column, first and second moment of a tile in
// one pass, compiled for every SIMD target by Highway.
//
// With D the pixel's direction (forward component 1), D0 that through the mean, p = t0 D0 the vector from the
// eye to the mean, t0 its forward component, and delta = D - D0, linear in the pixel's offset (x, y) from the
// projected mean, the point of the ray nearest in the Gaussian's metric lies at
//   t* = t0 (1 - q),   q = (W delta · W D) / |W D|²,   x* - mean = t0 [(1 - q) delta - q D0]
// so that with the plane's gradient g
//   phi(x*) = v + P - q (P + A),   P = t0 g·delta,   A = t0 g·D0,   P + A = t0 g·D
//   mean square = phi(x*)² + r² + (g·D)² h(u) / |W D|²,   u = k² - m²
// No term cancels: q is the ratio of forms that FarSplat has over the peak. Parallel rays are the limit: the
// step along the ray is linear in (x, y), too, so that phi(x*) = v + P with q = 0, and g·D is A alone.
//
// A component along rays of different directions is phi = D·u / |D| of a vector u: the same with v, A linear and
// P, r² quadratic in (x, y); the division by |D| is left to the end.
#pragma once

#include <array>
#include <vector>

#include "render/chebyshev_fit.h"
#include "render/splat/splat_kernels.h"

namespace vog::splat {

/// A scalar field along the pixels of a FarSplat, in units of ShownField.
struct PlaneSplat {
    float mean_x = 0, mean_y = 0;  ///< projected mean, from (column, row)
    float value = 0;               ///< v
    float x = 0, y = 0;            ///< P = x x + y y
    float along = 0;               ///< A
    float variance = 0;            ///< r²
    /// Times (P + A)² h / C it is (g·D)² h / |W D|², C that of FarSplat.
    float per_c = 0;
};
/// The component of a vector field along the ray, times |D|.
struct ViewSplat {
    float mean_x = 0, mean_y = 0, per_c = 0;
    std::array<float, 3> value{};     ///< D·v: 1, x, y
    std::array<float, 5> across{};    ///< P: x, y, x², x y, y²
    std::array<float, 3> along{};     ///< A: 1, x, y
    std::array<float, 6> variance{};  ///< Dᵀ R D: 1, x, y, x², x y, y²
};

/// h(u) = 1 - 2 z n(z) / (2 N(z) - 1), z = sqrt(u): the variance of a normal distribution cut at ± z.
using ChordVariance = ChebyshevFit;
/// Fits h over [0, k²].
/// cutoff  k, (0, 8]
ChordVariance fit_chord_variance(double cutoff, double tolerance = 1e-5);

/// Sums of tau / |D|, of that times phi, and times phi².
struct FieldTile {
    TilePixels sum[3];
};
/// Polynomials of a model's kernels.
struct FieldPolynomials {
    KernelPolynomial kernel;
    ChordVariance variance;
};

/// Pixels of one row, from sums to maps.
struct MapRow {
    float *column, *mean, *deviation;  ///< sums, replaced by the maps
    std::size_t count = 0;
    double depth_unit = 1;  ///< of the column, a power of two
    double unit = 1;        ///< ShownField::unit
    double reference = 0;   ///< of scalars
    /// Of a component along rays: direction of the first pixel with forward component 1 and its change, right
    /// and squared length without `right`; the reference across and its change from pixel to pixel.
    bool along_rays = false;
    double slope = 0, slope_step = 0, rest2 = 1, reference_step = 0;
};

/// The loops for one SIMD target: each adds splats[index[0]] ... to the pixels of a tile they touch.
struct FieldKernels {
    template <class Plane>
    using Add = void (*)(const FarSplat* splats, const Plane* planes, const std::uint32_t* index,
                         std::size_t count, const FieldPolynomials& polynomials, FieldTile& tile);
    Add<PlaneSplat> add_parallel, add_pinhole;
    Add<ViewSplat> add_view;
    void (*finish)(const MapRow& row);
};
/// Those of the same target as `kernels`.
const FieldKernels& field_kernels(const SplatKernels& kernels);

}  // namespace vog::splat
