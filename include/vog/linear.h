// vog/linear.h: the vectors, matrices, rotations, affine maps and boxes of the public interface.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace vog {

template <class Scalar>
struct Vec3 {
    Scalar x = 0, y = 0, z = 0;

    constexpr Scalar& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    constexpr const Scalar& operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
using Vec3i = Vec3<std::int32_t>;

template <class S>
constexpr Vec3<S> operator+(Vec3<S> a, Vec3<S> b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class S>
constexpr Vec3<S> operator-(Vec3<S> a, Vec3<S> b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class S>
constexpr Vec3<S> operator-(Vec3<S> a) {
    return {-a.x, -a.y, -a.z};
}
template <class S>
constexpr Vec3<S> operator*(S s, Vec3<S> a) {
    return {s * a.x, s * a.y, s * a.z};
}
template <class S>
constexpr S dot(Vec3<S> a, Vec3<S> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class S>
constexpr Vec3<S> cross(Vec3<S> a, Vec3<S> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class S>
S length(Vec3<S> a) {
    return std::sqrt(dot(a, a));
}
template <class S>
Vec3<S> normalized(Vec3<S> a) {
    return (S(1) / length(a)) * a;
}
template <class To, class From>
constexpr Vec3<To> vec_cast(Vec3<From> a) {
    return {static_cast<To>(a.x), static_cast<To>(a.y), static_cast<To>(a.z)};
}

/// 3x3 matrix of doubles, by rows.
struct Mat3 {
    std::array<Vec3d, 3> row{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};

    constexpr double operator()(int r, int c) const { return row[static_cast<std::size_t>(r)][c]; }
    constexpr double& operator()(int r, int c) { return row[static_cast<std::size_t>(r)][c]; }
    constexpr Vec3d column(int c) const { return {row[0][c], row[1][c], row[2][c]}; }
    friend constexpr bool operator==(const Mat3&, const Mat3&) = default;
};

constexpr Vec3d operator*(const Mat3& m, Vec3d v) {
    return {dot(m.row[0], v), dot(m.row[1], v), dot(m.row[2], v)};
}
constexpr Mat3 transpose(const Mat3& m) { return {{m.column(0), m.column(1), m.column(2)}}; }
constexpr Mat3 operator*(const Mat3& a, const Mat3& b) {
    const Mat3 bt = transpose(b);
    return {{bt * a.row[0], bt * a.row[1], bt * a.row[2]}};
}
constexpr double determinant(const Mat3& m) { return dot(m.row[0], cross(m.row[1], m.row[2])); }
/// Inverse by cofactors; a singular matrix gives infinities or NaN.
constexpr Mat3 inverse(const Mat3& m) {
    const double s = 1.0 / determinant(m);
    return transpose({{s * cross(m.row[1], m.row[2]), s * cross(m.row[2], m.row[0]),
                       s * cross(m.row[0], m.row[1])}});
}

/// Unit quaternion w + xi + yj + zk: the rotation that takes a Gaussian's own axes to world axes.
struct Quat {
    float w = 1, x = 0, y = 0, z = 0;
    friend constexpr bool operator==(const Quat&, const Quat&) = default;
};

/// Rotation matrix of a quaternion (normalised here, so any non-zero length will do).
Mat3 matrix_from_quat(Quat q);
/// Quaternion (w >= 0) of a proper rotation matrix.
Quat quat_from_matrix(const Mat3& rotation);

/// Eigenvalues, largest first, and right-handed unit eigenvectors (the columns of `axes`) of a
/// symmetric matrix, by cyclic Jacobi rotations: A = axes · diag(values) · axesᵀ.
struct Eigen3 {
    Vec3d values;
    Mat3 axes;
};
Eigen3 symmetric_eigen(const Mat3& symmetric);

/// x ↦ linear · x + translation. Named to_from: `world_from_index`.
struct Affine {
    Mat3 linear;
    Vec3d translation;

    constexpr Vec3d operator()(Vec3d point) const { return linear * point + translation; }
    friend constexpr bool operator==(const Affine&, const Affine&) = default;
};
/// Inverse map; the linear part must not be singular.
constexpr Affine inverse(const Affine& a) {
    const Mat3 linear = inverse(a.linear);
    return {linear, -(linear * a.translation)};
}

/// Axis-aligned box. The default is empty: lower > upper, and any include() replaces it.
struct Box {
    Vec3d lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                std::numeric_limits<double>::infinity()};
    Vec3d upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                -std::numeric_limits<double>::infinity()};

    bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
    Vec3d center() const { return 0.5 * (lower + upper); }
    /// Half the diagonal: the bounding radius of the `paper` view.
    double radius() const { return 0.5 * length(upper - lower); }
    void include(Vec3d point) {
        for (int axis = 0; axis < 3; ++axis) {
            lower[axis] = std::fmin(lower[axis], point[axis]);
            upper[axis] = std::fmax(upper[axis], point[axis]);
        }
    }
    void include(const Box& other) {
        if (other.empty()) return;
        include(other.lower);
        include(other.upper);
    }
    friend bool operator==(const Box&, const Box&) = default;
};

/// World-axis box around the eight mapped corners of `box`.
Box transformed(const Affine& map, const Box& box);

}  // namespace vog
