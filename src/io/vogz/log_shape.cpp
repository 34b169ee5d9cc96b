// log_shape.cpp: logarithm and exponential of covariances, on every SIMD target. foreach_target.h includes this file once
// for each target, so code outside HWY_NAMESPACE is guarded by HWY_ONCE.
#include "io/vogz/log_shape.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "io/vogz/log_shape.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include <hwy/contrib/math/math-inl.h>

#include <algorithm>
#include <cmath>
#include <limits>

#ifndef VOG_LOG_SHAPE_LANES
#define VOG_LOG_SHAPE_LANES

namespace vog::vogz {
/// Gaussians at a time: a multiple of the lanes of every target.
constexpr std::size_t kBlock = 64;

/// Matrices on their way to diagonal ones, and the rotations so far.
struct Turning {
    alignas(
        64) float m[6][kBlock];  ///< xx yy zz xy xz yz; at the end the first three, the others 0
    alignas(64) float q[4][kBlock];  ///< w x y z, of unit length, w >= 0
};

/// Gaussians on their way to the logarithms of their shapes.
struct Shapes {
    alignas(64) double q[4][kBlock];  ///< w x y z, of any length
    alignas(64) double scale[3][kBlock], log_scale[3][kBlock];
    alignas(64) double m[6][kBlock];       ///< xx yy zz xy xz yz
    alignas(64) double extent[3][kBlock];  ///< standard deviations along the world's axes
};
}  // namespace vog::vogz

#endif

HWY_BEFORE_NAMESPACE();
namespace vog::vogz {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kBlock>;
using Doubles = hn::CappedTag<double, kBlock>;
using Lane = hn::Vec<Floats>;

/// 1 / sqrt(x) to about the last digit, without a division.
HWY_INLINE Lane inverse_root(Lane x) {
    const Floats d;
    // From 8 binary digits and more, by two steps of Newton's.
    const Lane half_x = hn::Mul(hn::Set(d, 0.5f), x), most = hn::Set(d, 1.5f);
    Lane r = hn::ApproximateReciprocalSqrt(x);
    for (int step = 0; step < 2; ++step) r = hn::Mul(r, hn::NegMulAdd(hn::Mul(half_x, r), r, most));
    return r;
}

/// Jacobi rotation in the plane of axes P and Q about the third, R, right-handed from P to Q.
/// Entries of the matrix: PQ, and PR and QR of the two others.
template <std::size_t P, std::size_t Q, std::size_t R, std::size_t PQ, std::size_t PR,
          std::size_t QR>
HWY_INLINE void rotate(Lane* HWY_RESTRICT m, Lane* HWY_RESTRICT q) {
    const Floats d;
    const Lane half = hn::Set(d, 0.5f);
    // cos 2a = |qq - pp| root, sin 2a = 2 pq root of the angle a, at most 45 degrees; cosines and sines of a and a / 2 by
    // half angles, whose squares are 1/2 at least. Where all are 0, a difference makes the angle 0.
    constexpr float kLeast = 1e-15f;
    const Lane pq = m[PQ], difference = hn::Sub(m[Q], m[P]);
    const Lane distance = hn::Max(hn::Abs(difference), hn::Set(d, kLeast));
    const Lane twice = hn::Add(pq, pq);
    const Lane root = inverse_root(hn::MulAdd(distance, distance, hn::Mul(twice, twice)));
    const Lane cos2 = hn::MulAdd(half, hn::Mul(distance, root), half);
    const Lane over_cos = inverse_root(cos2);
    const Lane c = hn::Mul(cos2, over_cos);
    const Lane sign = hn::And(difference, hn::SignBit(d));
    const Lane s = hn::Mul(hn::Mul(hn::Xor(pq, sign), root), over_cos);
    const Lane tangent = hn::Mul(s, over_cos);
    m[P] = hn::NegMulAdd(tangent, pq, m[P]);
    m[Q] = hn::MulAdd(tangent, pq, m[Q]);
    m[PQ] = hn::Zero(d);
    const Lane pr = m[PR], qr = m[QR];
    m[PR] = hn::MulSub(c, pr, hn::Mul(s, qr));
    m[QR] = hn::MulAdd(s, pr, hn::Mul(c, qr));
    // The axes turn by the angle from Q to P: a quaternion of half of it about R, negative.
    const Lane half_cos2 = hn::MulAdd(half, c, half);
    const Lane over_half_cos = inverse_root(half_cos2);
    const Lane half_c = hn::Mul(half_cos2, over_half_cos);
    const Lane half_s = hn::Mul(hn::Mul(half, s), over_half_cos);
    const Lane w = q[0], x = q[1 + P], y = q[1 + Q], z = q[1 + R];
    q[0] = hn::MulAdd(half_c, w, hn::Mul(half_s, z));
    q[1 + R] = hn::MulSub(half_c, z, hn::Mul(half_s, w));
    q[1 + P] = hn::MulSub(half_c, x, hn::Mul(half_s, y));
    q[1 + Q] = hn::MulAdd(half_c, y, hn::Mul(half_s, x));
}

void diagonalize(Turning& turning) {
    const Floats d;
    for (std::size_t n = 0; n < kBlock; n += hn::Lanes(d)) {
        Lane m[6], q[4];
        for (int k = 0; k < 6; ++k) m[k] = hn::Load(d, turning.m[k] + n);
        q[0] = hn::Set(d, 1.0f);
        for (int k = 1; k < 4; ++k) q[k] = hn::Zero(d);
        // Each sweep about squares the entries beside the diagonal; four leave less than floats hold.
        constexpr int kSweeps = 4;
        for (int sweep = 0; sweep < kSweeps; ++sweep) {
            rotate<0, 1, 2, 3, 4, 5>(m, q);
            rotate<1, 2, 0, 5, 3, 4>(m, q);
            rotate<2, 0, 1, 4, 5, 3>(m, q);
        }
        Lane squares = hn::Zero(d);
        for (const Lane& component : q) squares = hn::MulAdd(component, component, squares);
        const Lane scale = hn::CopySign(hn::Div(hn::Set(d, 1.0f), hn::Sqrt(squares)), q[0]);
        for (int k = 0; k < 3; ++k) hn::Store(m[k], d, turning.m[k] + n);
        for (int k = 0; k < 4; ++k) hn::Store(hn::Mul(scale, q[k]), d, turning.q[k] + n);
    }
}

/// R diag(ln s) R^T, and the roots of the diagonal of R diag(s^2) R^T.
void set_matrices(Shapes& shapes) {
    const Doubles d;
    const auto one = hn::Set(d, 1.0), two = hn::Set(d, 2.0);
    for (std::size_t n = 0; n < kBlock; n += hn::Lanes(d)) {
        const auto of = [&](const double* numbers) HWY_ATTR { return hn::Load(d, numbers + n); };
        auto w = of(shapes.q[0]), x = of(shapes.q[1]), y = of(shapes.q[2]), z = of(shapes.q[3]);
        const auto squares = hn::MulAdd(w, w, hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))));
        // With 2 / |q|^2 once, all products are those of a unit quaternion, doubled.
        const auto norm = hn::Div(two, squares);
        const auto xn = hn::Mul(x, norm), yn = hn::Mul(y, norm), zn = hn::Mul(z, norm);
        const auto xx = hn::Mul(x, xn), yy = hn::Mul(y, yn), zz = hn::Mul(z, zn),
                   xy = hn::Mul(x, yn), xz = hn::Mul(x, zn), yz = hn::Mul(y, zn),
                   wx = hn::Mul(w, xn), wy = hn::Mul(w, yn), wz = hn::Mul(w, zn);
        const hn::Vec<Doubles> row[3][3] = {
            {hn::Sub(one, hn::Add(yy, zz)), hn::Sub(xy, wz), hn::Add(xz, wy)},
            {hn::Add(xy, wz), hn::Sub(one, hn::Add(xx, zz)), hn::Sub(yz, wx)},
            {hn::Sub(xz, wy), hn::Add(yz, wx), hn::Sub(one, hn::Add(xx, yy))}};
        const hn::Vec<Doubles> scale[3] = {of(shapes.scale[0]), of(shapes.scale[1]),
                                           of(shapes.scale[2])};
        const hn::Vec<Doubles> log_scale[3] = {of(shapes.log_scale[0]), of(shapes.log_scale[1]),
                                               of(shapes.log_scale[2])};
        const auto entry = [&](int a, int b) HWY_ATTR {
            auto sum = hn::Zero(d);
            for (int k = 0; k < 3; ++k)
                sum = hn::MulAdd(hn::Mul(row[a][k], row[b][k]), log_scale[k], sum);
            return sum;
        };
        hn::Store(entry(0, 0), d, shapes.m[0] + n);
        hn::Store(entry(1, 1), d, shapes.m[1] + n);
        hn::Store(entry(2, 2), d, shapes.m[2] + n);
        hn::Store(entry(0, 1), d, shapes.m[3] + n);
        hn::Store(entry(0, 2), d, shapes.m[4] + n);
        hn::Store(entry(1, 2), d, shapes.m[5] + n);
        for (int a = 0; a < 3; ++a) {
            auto sum = hn::Zero(d);
            for (int k = 0; k < 3; ++k) {
                const auto along = hn::Mul(row[a][k], scale[k]);
                sum = hn::MulAdd(along, along, sum);
            }
            hn::Store(hn::Sqrt(sum), d, shapes.extent[a] + n);
        }
    }
}

/// x[n] = function(x[n])
template <class Number, class Function>
HWY_INLINE void transform(Number* HWY_RESTRICT x, std::size_t count, const Function& function) {
    const hn::ScalableTag<Number> d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t n = 0;
    for (; n + lanes <= count; n += lanes) hn::StoreU(function(d, hn::LoadU(d, x + n)), d, x + n);
    if (n == count) return;
    HWY_ALIGN Number rest[HWY_MAX_BYTES / sizeof(Number)];
    std::fill_n(rest, lanes, Number{1});
    std::copy(x + n, x + count, rest);
    hn::Store(function(d, hn::Load(d, rest)), d, rest);
    std::copy_n(rest, count - n, x + n);
}

void nearest_wholes(const double* HWY_RESTRICT x, double factor, std::int64_t* HWY_RESTRICT out,
                    std::size_t count) {
    constexpr double kOnes = 0x1.8p52;  // its last bit counts ones
    const hn::ScalableTag<double> d;
    const hn::RebindToSigned<decltype(d)> whole;
    const auto ones = hn::Set(d, kOnes);
    const auto rounded = [&](auto v) HWY_ATTR {
        return hn::Sub(hn::BitCast(whole, hn::Add(hn::Mul(v, hn::Set(d, factor)), ones)),
                       hn::BitCast(whole, ones));
    };
    const std::size_t lanes = hn::Lanes(d);
    std::size_t n = 0;
    for (; n + lanes <= count; n += lanes) hn::StoreU(rounded(hn::LoadU(d, x + n)), whole, out + n);
    for (; n < count; ++n) out[n] = hn::GetLane(rounded(hn::Set(d, x[n])));
}
void exponentials(double* x, std::size_t count) {
    constexpr double kMost = 700;  // of Exp: 706
    transform(x, count, [](auto d, auto v) HWY_ATTR {
        return hn::Exp(d, hn::Clamp(v, hn::Set(d, -kMost), hn::Set(d, kMost)));
    });
}
void float_exponentials(float* x, std::size_t count) {
    constexpr float kMost = 80;  // of Exp: 104; floats end at 88
    transform(x, count, [](auto d, auto v) HWY_ATTR {
        return hn::Exp(d, hn::Clamp(v, hn::Set(d, -kMost), hn::Set(d, kMost)));
    });
}
void logarithms(double* x, std::size_t count) {
    transform(x, count, [](auto d, auto v) HWY_ATTR { return hn::Log(d, v); });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vog::vogz
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vog::vogz {

namespace {

HWY_EXPORT(diagonalize);
HWY_EXPORT(exponentials);
HWY_EXPORT(float_exponentials);
HWY_EXPORT(logarithms);
HWY_EXPORT(nearest_wholes);
HWY_EXPORT(set_matrices);

float within_floats(double scale) {
    using Limits = std::numeric_limits<float>;
    return static_cast<float>(
        std::clamp(scale, double{Limits::denorm_min()}, double{Limits::max()}));
}

}  // namespace

void take_exponentials(std::span<double> numbers) {
    HWY_DYNAMIC_DISPATCH(exponentials)(numbers.data(), numbers.size());
}
void take_nearest(std::span<const double> x, double factor, std::span<std::int64_t> nearest) {
    HWY_DYNAMIC_DISPATCH(nearest_wholes)(x.data(), factor, nearest.data(), x.size());
}
void take_logarithms(std::span<double> numbers) {
    HWY_DYNAMIC_DISPATCH(logarithms)(numbers.data(), numbers.size());
}

LogShapes log_shapes(const Gaussians& model, std::span<const std::uint32_t> index,
                     const std::array<std::vector<double>, 3>& log_scale) {
    LogShapes result;
    for (auto& entry : result.entry) entry.resize(index.size());
    for (auto& extent : result.extent) extent.resize(index.size());
    Shapes shapes{};
    for (auto& numbers : shapes.q[0]) numbers = 1;
    for (std::size_t first = 0; first < index.size(); first += kBlock) {
        const std::size_t count = std::min(kBlock, index.size() - first);
        for (std::size_t n = 0; n < count; ++n) {
            const std::uint32_t i = index[first + n];
            const Vec3f s = model.scale[i];
            shapes.scale[0][n] = double{s.x};
            shapes.scale[1][n] = double{s.y};
            shapes.scale[2][n] = double{s.z};
            if (model.axis_aligned()) continue;
            const Quat q = model.rotation[i];
            shapes.q[0][n] = double{q.w};
            shapes.q[1][n] = double{q.x};
            shapes.q[2][n] = double{q.y};
            shapes.q[3][n] = double{q.z};
        }
        for (std::size_t axis = 0; axis < 3; ++axis)
            std::copy_n(log_scale[axis].data() + first, count, shapes.log_scale[axis]);
        HWY_DYNAMIC_DISPATCH(set_matrices)(shapes);
        for (std::size_t k = 0; k < result.entry.size(); ++k)
            std::copy_n(shapes.m[k], count, result.entry[k].data() + first);
        for (std::size_t axis = 0; axis < 3; ++axis)
            std::copy_n(shapes.extent[axis], count, result.extent[axis].data() + first);
    }
    return result;
}

void set_shapes(Gaussians& model, std::size_t begin, const ShapeEntries& shapes,
                std::span<double> spread) {
    const auto& [xx, yy, zz, xy, xz, yz] = shapes;
    const std::size_t size = spread.size();
    // Matrices are relative to the mean of the diagonal: floats then hold what turns the axes.
    std::vector<double> mean(size);
    for (std::size_t n = 0; n < size; ++n) spread[n] = mean[n] = (xx[n] + yy[n] + zz[n]) / 3;
    take_exponentials(spread);
    Turning turning{};
    for (std::size_t first = 0; first < size; first += kBlock) {
        const std::size_t count = std::min(kBlock, size - first);
        const auto bounded = [](double v) {
            constexpr double kMost = 1e4;  // far beyond the logarithms of floats
            return static_cast<float>(std::clamp(v, -kMost, kMost));
        };
        for (std::size_t k = 0; k < kDiagonal; ++k)
            for (std::size_t n = 0; n < count; ++n)
                turning.m[k][n] = bounded(shapes[k][first + n] - mean[first + n]);
        if (!model.axis_aligned()) {
            for (std::size_t k = kDiagonal; k < shapes.size(); ++k)
                for (std::size_t n = 0; n < count; ++n)
                    turning.m[k][n] = bounded(shapes[k][first + n]);
            HWY_DYNAMIC_DISPATCH(diagonalize)(turning);
            for (std::size_t n = 0; n < count; ++n)
                model.rotation[begin + first + n] = {turning.q[0][n], turning.q[1][n],
                                                     turning.q[2][n], turning.q[3][n]};
        }
        HWY_DYNAMIC_DISPATCH(float_exponentials)(turning.m[0], kDiagonal * kBlock);
        for (std::size_t n = 0; n < count; ++n) {
            const double s = spread[first + n];
            model.scale[begin + first + n] = {within_floats(s * double{turning.m[0][n]}),
                                              within_floats(s * double{turning.m[1][n]}),
                                              within_floats(s * double{turning.m[2][n]})};
        }
    }
}

}  // namespace vog::vogz
#endif
