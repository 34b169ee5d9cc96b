// linear.cpp: rotations, eigenvectors and mapped boxes.
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
    // Shepperd's method: take the root of the largest of 4w², 4x², 4y², 4z², so nothing cancels.
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

Eigen3 symmetric_eigen(const Mat3& symmetric) {
    Mat3 a = symmetric, axes;
    // Cyclic Jacobi: each rotation zeroes one off-diagonal pair; convergence is quadratic, so a
    // dozen sweeps leave nothing in double precision.
    constexpr int kSweeps = 12;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        const double off = std::abs(a(0, 1)) + std::abs(a(0, 2)) + std::abs(a(1, 2));
        if (off == 0) break;
        for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
            if (a(p, q) == 0) continue;
            const double theta = (a(q, q) - a(p, p)) / (2 * a(p, q));
            const double t =
                (theta < 0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
            const double c = 1 / std::sqrt(t * t + 1), s = t * c;
            for (int k = 0; k < 3; ++k) {
                const double akp = a(k, p), akq = a(k, q);
                a(k, p) = c * akp - s * akq, a(k, q) = s * akp + c * akq;
            }
            for (int k = 0; k < 3; ++k) {
                const double apk = a(p, k), aqk = a(q, k);
                a(p, k) = c * apk - s * aqk, a(q, k) = s * apk + c * aqk;
            }
            a(p, q) = a(q, p) = 0;
            for (int k = 0; k < 3; ++k) {
                const double vkp = axes(k, p), vkq = axes(k, q);
                axes(k, p) = c * vkp - s * vkq, axes(k, q) = s * vkp + c * vkq;
            }
        }
    }
    // Largest first, then right-handed.
    std::array<int, 3> order{0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return a(i, i) > a(j, j); });
    Eigen3 result;
    for (int c = 0; c < 3; ++c) {
        result.values[c] = a(order[c], order[c]);
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
