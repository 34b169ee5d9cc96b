// log_shape.cpp: logarithm and exponential of covariances.
#include "io/vogz/log_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vog::vogz {

namespace {

float scale_of(double logarithm) {
    using Limits = std::numeric_limits<float>;
    return std::clamp(static_cast<float>(std::exp(std::clamp(logarithm, -200.0, 200.0))),
                      Limits::denorm_min(), Limits::max());
}

/// Matrices at a time: loops over lanes become vector instructions.
constexpr std::size_t kLanes = 8;
using Lanes = std::array<float, kLanes>;

/// Symmetric matrices on their way to diagonal ones, and the rotations so far, w x y z.
struct Turning {
    std::array<Lanes, 6> m;  ///< xx yy zz xy xz yz
    std::array<Lanes, 4> q;
};

/// Jacobi rotation in the plane of axes P and Q about the third, R, right-handed from P to Q.
/// Entries of the matrix: PQ, and PR and QR of the two others.
template <std::size_t P, std::size_t Q, std::size_t R, std::size_t PQ, std::size_t PR,
          std::size_t QR>
void rotate(Turning& t) {
    for (std::size_t n = 0; n < kLanes; ++n) {
        // tan of the angle: the smaller root of t^2 + 2 tau t - 1, in a form without cancellation or infinities.
        const float pq = t.m[PQ][n];
        const float difference = t.m[Q][n] - t.m[P][n];
        const float length = std::sqrt(difference * difference + 4 * pq * pq);
        const float below = std::abs(difference) + length;
        const float tangent =
            2 * std::copysign(pq, difference < 0 ? -pq : pq) / (below > 0 ? below : 1.0f);
        const float c = 1 / std::sqrt(1 + tangent * tangent);
        const float s = tangent * c;
        t.m[P][n] -= tangent * pq;
        t.m[Q][n] += tangent * pq;
        t.m[PQ][n] = 0;
        const float pr = t.m[PR][n], qr = t.m[QR][n];
        t.m[PR][n] = c * pr - s * qr;
        t.m[QR][n] = s * pr + c * qr;
        // The axes turn by the angle from Q to P: a quaternion of half of it about R, negative.
        const float half_c = std::sqrt(0.5f * (1 + c));
        const float half_s = -0.5f * s / half_c;
        std::array<float, 4> q{t.q[0][n], t.q[1][n], t.q[2][n], t.q[3][n]};
        t.q[0][n] = half_c * q[0] - half_s * q[1 + R];
        t.q[1 + R][n] = half_c * q[1 + R] + half_s * q[0];
        t.q[1 + P][n] = half_c * q[1 + P] + half_s * q[1 + Q];
        t.q[1 + Q][n] = half_c * q[1 + Q] - half_s * q[1 + P];
    }
}

}  // namespace

LogShape log_shape(const Gaussians& model, std::size_t i) {
    const Vec3f s = model.scale[i];
    const Vec3d l{std::log(double{s.x}), std::log(double{s.y}), std::log(double{s.z})};
    if (model.axis_aligned()) return {l.x, l.y, l.z};
    const Mat3 r = matrix_from_quat(model.rotation[i]);
    const auto entry = [&](std::size_t a, std::size_t b) {
        const Vec3d p = r.row[a], q = r.row[b];
        return p.x * q.x * l.x + p.y * q.y * l.y + p.z * q.z * l.z;
    };
    return {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)};
}

void set_shapes(Gaussians& model, std::size_t begin, std::span<const LogShape> shapes) {
    if (model.axis_aligned()) {
        for (std::size_t n = 0; n < shapes.size(); ++n) {
            const LogShape& l = shapes[n];
            model.scale[begin + n] = {scale_of(l[0]), scale_of(l[1]), scale_of(l[2])};
        }
        return;
    }
    for (std::size_t first = 0; first < shapes.size(); first += kLanes) {
        const std::size_t count = std::min(kLanes, shapes.size() - first);
        // Relative to the mean of the diagonal: floats then hold what turns the axes.
        Turning t{};
        std::array<double, kLanes> mean{};
        t.q[0].fill(1);
        for (std::size_t n = 0; n < count; ++n) {
            const LogShape& l = shapes[first + n];
            mean[n] = (l[0] + l[1] + l[2]) / 3;
            for (std::size_t k = 0; k < l.size(); ++k) {
                constexpr double kMost = 1e4;  // far beyond the logarithms of floats
                const double entry = k < kDiagonal ? l[k] - mean[n] : l[k];
                t.m[k][n] = static_cast<float>(std::clamp(entry, -kMost, kMost));
            }
        }
        // Each sweep about squares the entries beside the diagonal; four leave less than floats hold.
        constexpr int kSweeps = 4;
        for (int sweep = 0; sweep < kSweeps; ++sweep) {
            rotate<0, 1, 2, 3, 4, 5>(t);
            rotate<1, 2, 0, 5, 3, 4>(t);
            rotate<2, 0, 1, 4, 5, 3>(t);
        }
        for (std::size_t n = 0; n < count; ++n) {
            const std::size_t i = begin + first + n;
            model.scale[i] = {scale_of(mean[n] + double{t.m[0][n]}),
                              scale_of(mean[n] + double{t.m[1][n]}),
                              scale_of(mean[n] + double{t.m[2][n]})};
            const float w = t.q[0][n], x = t.q[1][n], y = t.q[2][n], z = t.q[3][n];
            const float sign = std::copysign(1 / std::sqrt(w * w + x * x + y * y + z * z), w);
            model.rotation[i] = {sign * w, sign * x, sign * y, sign * z};
        }
    }
}

}  // namespace vog::vogz
