// responsibility_kernels.cpp: quadratic forms as polynomials in x, whose coefficients stay in
// registers for a pair of rows: a dozen operations a point. foreach_target.h includes this file
// once for each target, so code outside HWY_NAMESPACE is guarded by HWY_ONCE.
#include "convert/moments/em/responsibility_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "convert/moments/em/responsibility_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vog::moments {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, kRun>;
using Floats = hn::Vec<Tag>;

/// Row, and position along z, of the points of a run.
alignas(64) constexpr float kRow[kRun] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1};
alignas(64) constexpr float kPlace[kRun] = {0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7};

/// Coordinates relative to the mean, for lanes of a run.
HWY_INLINE Floats run_y(const RunKernel& k, int pair, std::size_t lane) {
    const Tag d;
    const Floats first = hn::Set(d, k.dy + k.step * static_cast<float>(2 * pair));
    return hn::Add(first, hn::Mul(hn::Set(d, k.step), hn::Load(d, kRow + lane)));
}
HWY_INLINE Floats run_z(const RunKernel& k, std::size_t lane) {
    const Tag d;
    return hn::Add(hn::Set(d, k.dz), hn::Mul(hn::Set(d, k.step), hn::Load(d, kPlace + lane)));
}

/// u at the edge of the support.
constexpr float kEnd = static_cast<float>(kSupportDeviations * kSupportDeviations) / 32;

void add_one(const RunKernel& k, float* values, float* sum) {
    const Tag d;
    const Floats zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f),
                 end = hn::Set(d, kEnd), peak = hn::Set(d, k.peak);
    const int columns = k.x1 - k.x0 + 1;
    for (std::size_t lane = 0; lane < kRun; lane += hn::Lanes(d)) {
        const Floats z = run_z(k, lane);
        const Floats linear_z = hn::Mul(hn::Set(d, k.xz), z),
                     mixed_z = hn::Mul(hn::Set(d, k.yz), z);
        const Floats constant_z = hn::Mul(hn::Mul(hn::Set(d, k.zz), z), z);
        float* to = values + lane;
        for (int pair = k.y0; pair <= k.y1; ++pair) {
            // u = constant + x (linear + x xx)
            const Floats y = run_y(k, pair, lane);
            const Floats linear = hn::Add(linear_z, hn::Mul(hn::Set(d, k.xy), y));
            const Floats constant =
                hn::Add(constant_z, hn::Mul(y, hn::Add(mixed_z, hn::Mul(hn::Set(d, k.yy), y))));
            float* total = sum + kRun * pair + static_cast<int>(lane) + (k.x0 << 6);
            for (int n = 0; n < columns; ++n, to += kRun, total += 64) {
                const float x = k.dx + k.step * static_cast<float>(k.x0 + n);
                const Floats inner = hn::Add(linear, hn::Set(d, x * k.xx));
                // Below 0 by rounding alone: by 1e-7, or beyond all bounds for a needle of 10^6
                // voxels, whose mass would be lost.
                const Floats u = hn::Max(zero, hn::Add(constant, hn::Mul(hn::Set(d, x), inner)));
                // Second-order Taylor polynomial of exp(-u), to the 16th power: too large by 6e-3
                // at two standard deviations, by 8e-2 at three, relatively.
                Floats t = hn::Sub(one, hn::Mul(u, hn::Sub(one, hn::Mul(half, u))));
                t = hn::Mul(t, t), t = hn::Mul(t, t), t = hn::Mul(t, t), t = hn::Mul(t, t);
                const Floats value = hn::IfThenElseZero(hn::Lt(u, end), hn::Mul(peak, t));
                hn::Store(value, d, to);
                hn::Store(hn::Add(hn::Load(d, total), value), d, total);
            }
        }
    }
}

/// Moments about the mean, summed separately in each lane.
enum { kM, kX, kY, kZ, kXX, kXY, kXZ, kYY, kYZ, kZZ, kSums };
struct LaneSums {
    alignas(64) float of[kSums][kRun];
};

void responsibilities_of_one(const RunKernel& k, const float* values, const float* weight,
                             LaneSums& to) {
    const Tag d;
    const int columns = k.x1 - k.x0 + 1;
    for (std::size_t lane = 0; lane < kRun; lane += hn::Lanes(d)) {
        Floats m = hn::Zero(d), mx = m, mxx = m, my = m, mxy = m, myy = m;
        const float* from = values + lane;
        for (int pair = k.y0; pair <= k.y1; ++pair) {
            Floats run = hn::Zero(d), run_x = run, run_xx = run;
            const float* shared = weight + kRun * pair + static_cast<int>(lane) + (k.x0 << 6);
            for (int n = 0; n < columns; ++n, from += kRun, shared += 64) {
                const Floats x = hn::Set(d, k.dx + k.step * static_cast<float>(k.x0 + n));
                const Floats share = hn::Mul(hn::Load(d, from), hn::Load(d, shared));
                const Floats share_x = hn::Mul(share, x);
                run = hn::Add(run, share);
                run_x = hn::Add(run_x, share_x);
                run_xx = hn::Add(run_xx, hn::Mul(share_x, x));
            }
            const Floats y = run_y(k, pair, lane), along_y = hn::Mul(run, y);
            m = hn::Add(m, run);
            mx = hn::Add(mx, run_x);
            mxx = hn::Add(mxx, run_xx);
            my = hn::Add(my, along_y);
            mxy = hn::Add(mxy, hn::Mul(run_x, y));
            myy = hn::Add(myy, hn::Mul(along_y, y));
        }
        const Floats z = run_z(k, lane), mz = hn::Mul(m, z);
        const auto store = [&](int sum, Floats value) { hn::Store(value, d, to.of[sum] + lane); };
        store(kM, m), store(kX, mx), store(kY, my), store(kZ, mz);
        store(kXX, mxx), store(kXY, mxy), store(kXZ, hn::Mul(mx, z));
        store(kYY, myy), store(kYZ, hn::Mul(my, z)), store(kZZ, hn::Mul(mz, z));
    }
}

/// Adds the lanes in a fixed tree: the same bytes for any vector width.
void add_lanes(const LaneSums& lanes, MomentSums& to) {
    const auto all = [&](int sum) {
        const float* s = lanes.of[sum];
        const float low = ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
        const float high = ((s[8] + s[9]) + (s[10] + s[11])) + ((s[12] + s[13]) + (s[14] + s[15]));
        return double{low + high};
    };
    to.mass += all(kM);
    to.first = to.first + Vec3d{all(kX), all(kY), all(kZ)};
    for (int n = 0; n < 6; ++n) to.second[static_cast<std::size_t>(n)] += all(kXX + n);
}

void add_all(std::span<const RunKernel> kernels, float* values, BrickFloats& sum) {
    for (const RunKernel& k : kernels)
        if (k.run_count() > 0) add_one(k, values + kRun * k.first_run, sum.data());
}

bool divide(const float* value, float volume, BrickFloats& sum) {
    const Tag d;
    const Floats zero = hn::Zero(d), least_sum = hn::Set(d, kLeastSum);
    Floats uncovered = zero;  // largest mass of a point that is not covered
    for (std::size_t n = 0; n < kLeafVoxels; n += hn::Lanes(d)) {
        const Floats mass = hn::Mul(hn::Set(d, volume), hn::LoadU(d, value + n));
        const Floats all = hn::Load(d, sum.data() + n);
        const auto covered = hn::Gt(all, hn::Mul(least_sum, mass));
        uncovered = hn::Max(uncovered, hn::IfThenZeroElse(covered, mass));
        hn::Store(hn::IfThenElseZero(covered, hn::Div(mass, all)), d, sum.data() + n);
    }
    return !hn::AllFalse(d, hn::Gt(uncovered, zero));
}

void responsibilities_of_all(std::span<const RunKernel> kernels, const float* values,
                             const BrickFloats& weight, std::span<MomentSums> parts) {
    LaneSums lanes;
    for (std::size_t i = 0; i < kernels.size(); ++i) {
        const RunKernel& k = kernels[i];
        if (k.run_count() == 0) continue;
        responsibilities_of_one(k, values + kRun * k.first_run, weight.data(), lanes);
        add_lanes(lanes, parts[i]);
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vog::moments
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vog::moments {

namespace {
HWY_EXPORT(add_all);
HWY_EXPORT(divide);
HWY_EXPORT(responsibilities_of_all);
}  // namespace

void add_values(std::span<const RunKernel> kernels, float* values, BrickFloats& sum) {
    HWY_DYNAMIC_DISPATCH(add_all)(kernels, values, sum);
}

bool responsibility_weights(const float* value, float volume, BrickFloats& sum) {
    return HWY_DYNAMIC_DISPATCH(divide)(value, volume, sum);
}

void add_responsibilities(std::span<const RunKernel> kernels, const float* values,
                          const BrickFloats& weight, std::span<MomentSums> parts) {
    HWY_DYNAMIC_DISPATCH(responsibilities_of_all)(kernels, values, weight, parts);
}

}  // namespace vog::moments
#endif  // HWY_ONCE
