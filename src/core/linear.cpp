// linear.cpp: rotations as quaternions and matrices, eigenvectors, and boxes under affine maps.
#include "vog/linear.h"

#include <algorithm>
#include <utility>

namespace vog {

Mat3 matrix_from_quat(Quat q) {
    const double norm = 1.0 / std::sqrt(double(q.w) * q.w + double(q.x) * q.x + double(q.y) * q.y +
                                        double(q.z) * q.z);
    const double w = q.w * norm, x = q.x * norm, y = q.y * norm, z = q.z * norm;
    return {{Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
             Vec3d{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
             Vec3d{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

Quat quat_from_matrix(const Mat3& m) {
    // Shepperd's method: divide by the largest of w, x, y, z, so that nothing cancels.
    const double trace = m(0, 0) + m(1, 1) + m(2, 2);
    double w, x, y, z;
    if (trace >= m(0, 0) && trace >= m(1, 1) && trace >= m(2, 2)) {
        w = 1 + trace, x = m(2, 1) - m(1, 2), y = m(0, 2) - m(2, 0), z = m(1, 0) - m(0, 1);
    } else if (m(0, 0) >= m(1, 1) && m(0, 0) >= m(2, 2)) {
        w = m(2, 1) - m(1, 2), x = 1 + 2 * m(0, 0) - trace, y = m(1, 0) + m(0, 1),
        z = m(0, 2) + m(2, 0);
    } else if (m(1, 1) >= m(2, 2)) {
        w = m(0, 2) - m(2, 0), x = m(1, 0) + m(0, 1), y = 1 + 2 * m(1, 1) - trace,
        z = m(2, 1) + m(1, 2);
    } else {
        w = m(1, 0) - m(0, 1), x = m(0, 2) + m(2, 0), y = m(2, 1) + m(1, 2),
        z = 1 + 2 * m(2, 2) - trace;
    }
    const double norm = (w < 0 ? -1.0 : 1.0) / std::sqrt(w * w + x * x + y * y + z * z);
    return {float(w * norm), float(x * norm), float(y * norm), float(z * norm)};
}

namespace {

/// One Jacobi rotation: zeroes the off-diagonal element `pq` of axes p and q, and updates their
/// elements `rp` and `rq` with the third axis.
void rotate(double& pp, double& qq, double& pq, double& rp, double& rq, Mat3& axes, int p, int q) {
    // Below this share of the diagonal an element does not change it in double precision.
    constexpr double kNegligible = 1e-17;
    if (std::abs(pq) <= kNegligible * (std::abs(pp) + std::abs(qq))) {
        pq = 0;
        return;
    }
    const double theta = (qq - pp) / (2 * pq);
    const double t = (theta < 0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
    const double c = 1 / std::sqrt(t * t + 1), s = t * c;
    pp -= t * pq, qq += t * pq, pq = 0;
    const double old_rp = rp, old_rq = rq;
    rp = c * old_rp - s * old_rq, rq = s * old_rp + c * old_rq;
    for (Vec3d& row : axes.row) {
        const double vp = row[p], vq = row[q];
        row[p] = c * vp - s * vq, row[q] = s * vp + c * vq;
    }
}

}  // namespace

Eigen3 symmetric_eigen(const Mat3& symmetric) {
    const Mat3& m = symmetric;
    Mat3 axes;
    // Cyclic Jacobi: each rotation zeroes one off-diagonal element; convergence is quadratic, and
    // twelve sweeps are more than double precision needs.
    double xx = m(0, 0), yy = m(1, 1), zz = m(2, 2), xy = m(0, 1), xz = m(0, 2), yz = m(1, 2);
    constexpr int kSweeps = 12;
    for (int sweep = 0; sweep < kSweeps && (xy != 0 || xz != 0 || yz != 0); ++sweep) {
        rotate(xx, yy, xy, xz, yz, axes, 0, 1);
        rotate(xx, zz, xz, xy, yz, axes, 0, 2);
        rotate(yy, zz, yz, xy, xz, axes, 1, 2);
    }
    const std::array<double, 3> value{xx, yy, zz};
    // Largest eigenvalue first; the last axis is flipped if the basis is left-handed.
    std::array<int, 3> order{0, 1, 2};
    const auto before = [&](int i, int j) {
        if (value[order[j]] > value[order[i]]) std::swap(order[i], order[j]);
    };
    before(0, 1), before(1, 2), before(0, 1);
    Eigen3 result;
    for (int c = 0; c < 3; ++c) {
        result.values[c] = value[order[c]];
        for (int r = 0; r < 3; ++r) result.axes(r, c) = axes(r, order[c]);
    }
    if (determinant(result.axes) < 0)
        for (int r = 0; r < 3; ++r) result.axes(r, 2) = -result.axes(r, 2);
    return result;
}

Box transformed(const Affine& map, const Box& box) {
    Box mapped;
    if (box.empty()) return mapped;
    for (int corner = 0; corner < 8; ++corner)
        mapped.include(
            map({corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                 corner & 4 ? box.upper.z : box.lower.z}));
    return mapped;
}

}  // namespace vog
