// field_kernels.cpp: Compiles the field loops for every SIMD target, and fits the variance along a chord.
// foreach_target.h includes this file once per target: code outside HWY_NAMESPACE is guarded.
#include "render/splat/fields/field_kernels.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/splat/fields/field_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vog::splat {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#include "render/splat/splat_rows-inl.h"

#include "render/splat/fields/field_rows-inl.h"

template <class Tags>
const FieldKernels& kernels_of() {
    static const FieldKernels kernels{add_fields<true, Tags, PlaneSplat>,
                                      add_fields<false, Tags, PlaneSplat>,
                                      add_fields<false, Tags, ViewSplat>, finish_row<Tags>};
    return kernels;
}
/// The kernels of this target if it is `target`, else null.
const FieldKernels* field_kernels_of(std::int64_t target) {
    return target == HWY_TARGET ? &kernels_of<WideLanes>() : nullptr;
}
const FieldKernels* one_lane_field_kernels() { return &kernels_of<OneLane>(); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vog::splat
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vog::splat {

namespace {

HWY_EXPORT(field_kernels_of);
HWY_EXPORT(one_lane_field_kernels);

double chord_variance(double u) {
    // u / 3 - 2 u² / 45 + ...: below, the closed form cancels.
    constexpr double kSmall = 1e-4;
    if (u < kSmall) return u / 3 - 2 * u * u / 45;
    const double z = std::sqrt(u);
    return 1 - 2 * z * std::exp(-0.5 * u) * std::numbers::inv_sqrtpi / std::numbers::sqrt2 /
                   std::erf(z / std::numbers::sqrt2);
}

}  // namespace

ChordVariance fit_chord_variance(double cutoff, double tolerance) {
    constexpr std::size_t kMost = 30;  // k = 8 needs 24 for 1e-5
    return fit_chebyshev(chord_variance, cutoff * cutoff, tolerance, kMost);
}

const FieldKernels& field_kernels(const SplatKernels& kernels) {
    if (kernels.target != 0)
        for (const auto entry : HWY_DISPATCH_TABLE(field_kernels_of)) {
            if (entry == nullptr || entry == HWY_DISPATCH_TABLE(field_kernels_of)[0]) continue;
            if (const FieldKernels* found = entry(kernels.target)) return *found;
        }
    return *HWY_STATIC_DISPATCH(one_lane_field_kernels)();
}

}  // namespace vog::splat
#endif  // HWY_ONCE
