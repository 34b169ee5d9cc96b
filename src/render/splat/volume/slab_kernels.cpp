// slab_kernels.cpp: Compiles the loops over depth slabs for every SIMD target, and fits their polynomials.
// foreach_target.h includes this file once per target: code outside HWY_NAMESPACE is guarded.
#include "render/splat/volume/slab_kernels.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

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

#include "render/splat/volume/slab_rows-inl.h"

template <class Tags>
const SlabKernels& kernels_of() {
    static const SlabKernels kernels{add_lights<true, Tags>, add_lights<false, Tags>,
                                     composite_band<Tags>};
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

using Function = std::function<double(double)>;

double horner(const std::vector<double>& coefficient, double v) {
    double sum = 0;
    for (auto c = coefficient.rbegin(); c != coefficient.rend(); ++c) sum = sum * v + *c;
    return sum;
}

/// The interpolant at the zeros of a Chebyshev polynomial over x = half (v + 1), in powers of v.
std::vector<double> interpolant(const Function& of, std::size_t count, double half) {
    std::vector<double> series(count, 0.0);
    for (std::size_t node = 0; node < count; ++node) {
        const double theta = std::numbers::pi * (static_cast<double>(node) + 0.5) / double(count);
        const double value = of(half * (std::cos(theta) + 1));
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

/// The polynomial of lowest degree, from `least` coefficients on, within a tolerance.
SlabPolynomial fit(const Function& of, double cutoff, double tolerance, std::size_t least) {
    const double half = 0.5 * cutoff * cutoff;
    constexpr std::size_t kMaxCount = 32;
    for (std::size_t count = least;; ++count) {
        const std::vector<double> power = interpolant(of, count, half);
        double worst = 0;
        constexpr int kProbes = 400;
        for (int probe = 0; probe <= kProbes; ++probe) {
            const double v = -1 + 2.0 * probe / kProbes;
            worst = std::max(worst, std::abs(horner(power, v) - of(half * (v + 1))));
        }
        if (worst > tolerance && count < kMaxCount) continue;
        return {{power.begin(), power.end()}, static_cast<float>(1 / half), worst};
    }
}

}  // namespace

SlabPolynomials fit_slab_polynomials(double cutoff, double tolerance) {
    const auto part = [](double square) {
        const double u = std::sqrt(square);
        if (u < 1e-4) return 1 - square / 6;
        return std::sqrt(std::numbers::pi / 2) * std::erf(u / std::numbers::sqrt2) / u;
    };
    const auto peak = [&](double x) { return std::exp(0.5 * (x - cutoff * cutoff)); };
    return {fit(part, cutoff, tolerance, 2), fit(peak, cutoff, tolerance, 2)};
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
