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

double horner(const std::vector<double>& coefficient, double v) {
    double sum = 0;
    for (auto c = coefficient.rbegin(); c != coefficient.rend(); ++c) sum = sum * v + *c;
    return sum;
}

/// The interpolant at the zeros of a Chebyshev polynomial over u = half (v + 1), in powers of v.
std::vector<double> interpolant(std::size_t count, double half) {
    std::vector<double> series(count, 0.0);
    for (std::size_t node = 0; node < count; ++node) {
        const double theta = std::numbers::pi * (static_cast<double>(node) + 0.5) / double(count);
        const double value = chord_variance(half * (std::cos(theta) + 1));
        for (std::size_t j = 0; j < count; ++j)
            series[j] += (j == 0 ? 1.0 : 2.0) / double(count) * value * std::cos(double(j) * theta);
    }
    // T_0 = 1, T_{j+1} = 2 v T_j - T_{j-1}, with T_{-1} = T_1 = v.
    std::vector<double> power(count, 0.0), current(count, 0.0), previous(count, 0.0);
    current[0] = 1;
    if (count > 1) previous[1] = 1;
    for (std::size_t j = 0; j < count; ++j) {
        std::vector<double> next(count, 0.0);
        for (std::size_t i = 0; i < count; ++i) {
            power[i] += series[j] * current[i];
            if (i + 1 < count) next[i + 1] += 2 * current[i];
            next[i] -= previous[i];
        }
        previous = current;
        current = next;
    }
    return power;
}

}  // namespace

ChordVariance fit_chord_variance(double cutoff, double tolerance) {
    const double half = 0.5 * cutoff * cutoff;
    constexpr std::size_t kMaxCount = 30;  // k = 8 needs 24 for 1e-5
    for (std::size_t count = 2;; ++count) {
        const std::vector<double> power = interpolant(count, half);
        double worst = 0;
        constexpr int kProbes = 500;
        for (int probe = 0; probe <= kProbes; ++probe) {
            const double v = -1 + 2.0 * probe / kProbes;
            worst = std::max(worst, std::abs(horner(power, v) - chord_variance(half * (v + 1))));
        }
        if (worst > tolerance && count < kMaxCount) continue;
        return {{power.begin(), power.end()}, static_cast<float>(1 / half), worst};
    }
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
