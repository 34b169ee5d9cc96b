// slab_kernels.cpp: Compiles the loops over depth slabs for every SIMD target, and fits their polynomials.
// foreach_target.h includes this file once per target: code outside HWY_NAMESPACE is guarded.
#include "render/splat/volume/slab_kernels.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/by_value/volume_image.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/splat/volume/slab_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace vog::splat {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#include "render/splat/splat_rows-inl.h"

#include "render/splat/volume/slab_light-inl.h"

#include "render/splat/volume/slab_finish-inl.h"

#include "render/splat/volume/slab_layers-inl.h"

#include "render/splat/volume/slab_maximum-inl.h"

#include "render/splat/volume/slab_rows-inl.h"

template <class Tags>
const SlabKernels& kernels_of() {
    static const SlabKernels kernels{sum_cell<Tags>, draw_cell<Tags>, composite_cell<Tags>,
                                     maximum_cell<Tags>, composite_layers<Tags>};
    return kernels;
}
/// The kernels of this target if it is `target`, else null.
const SlabKernels* slab_kernels_of(std::int64_t target) {
    return target == HWY_TARGET ? &kernels_of<WideLanes>() : nullptr;
}
const SlabKernels* one_lane_slab_kernels() { return &kernels_of<OneLane>(); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vog::splat
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vog::splat {

namespace {

HWY_EXPORT(slab_kernels_of);
HWY_EXPORT(one_lane_slab_kernels);

}  // namespace

SlabPolynomials fit_slab_polynomials(double cutoff, double tolerance) {
    const auto part = [](double square) {
        const double u = std::sqrt(square);
        if (u < 1e-4) return 1 - square / 6;
        return std::sqrt(std::numbers::pi / 2) * std::erf(u / std::numbers::sqrt2) / u;
    };
    const auto peak = [&](double x) { return std::exp(0.5 * (x - cutoff * cutoff)); };
    constexpr std::size_t kMost = 32;
    const double square = cutoff * cutoff;
    return {fit_chebyshev(part, square, tolerance, kMost),
            fit_chebyshev(peak, square, tolerance, kMost)};
}

const SlabKernels& slab_kernels(const SplatKernels& kernels) {
    if (kernels.target != 0)
        for (const auto entry : HWY_DISPATCH_TABLE(slab_kernels_of)) {
            if (entry == nullptr || entry == HWY_DISPATCH_TABLE(slab_kernels_of)[0]) continue;
            if (const SlabKernels* found = entry(kernels.target)) return *found;
        }
    return *HWY_STATIC_DISPATCH(one_lane_slab_kernels)();
}

}  // namespace vog::splat
#endif  // HWY_ONCE
