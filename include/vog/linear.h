// vog/linear.h: vectors, matrices, rotations, affine maps and boxes. Units are those of the caller.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace vog {

/// Vector of three components. operator[] takes an axis: 0 (x), 1 (y) or 2 (z).
template <class Scalar>
struct Vec3 {
    Scalar x = 0, y = 0, z = 0;

    constexpr Scalar& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    constexpr const Scalar& operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
using Vec3i = Vec3<std::int32_t>;  ///< voxel indices, mostly

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
/// Euclidean length.
template <class S>
S length(Vec3<S> a) {
    return std::sqrt(dot(a, a));
}
/// a / |a|; NaN for a zero vector.
template <class S>
Vec3<S> normalized(Vec3<S> a) {
    return (S(1) / length(a)) * a;
}
template <class S>
bool finite(Vec3<S> a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
/// Components converted to another type by static_cast.
template <class To, class From>
constexpr Vec3<To> vec_cast(Vec3<From> a) {
    return {static_cast<To>(a.x), static_cast<To>(a.y), static_cast<To>(a.z)};
}

/// 3x3 matrix of doubles, stored by rows; the default is the identity. m(r, c): row r, column c,
/// both 0 to 2.
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

/// Unit quaternion w + xi + yj + zk: rotation from a Gaussian's own axes to the world axes. The
/// default is no rotation.
struct Quat {
    float w = 1, x = 0, y = 0, z = 0;
    friend constexpr bool operator==(const Quat&, const Quat&) = default;
};

/// Rotation matrix of a quaternion, which is normalised first.
/// q  of any length but zero
Mat3 matrix_from_quat(Quat q);
/// Unit quaternion of a rotation matrix, by Shepperd's method.
/// rotation  orthonormal, determinant +1
/// returns   w >= 0
Quat quat_from_matrix(const Mat3& rotation);

/// Eigendecomposition of a symmetric matrix: A = axes · diag(values) · axesᵀ.
struct Eigen3 {
    Vec3d values;  ///< eigenvalues, largest first
    Mat3 axes;     ///< unit eigenvectors as columns, in the order of `values`, right-handed
};
/// Eigendecomposition by cyclic Jacobi rotations. Only the upper triangle is read.
Eigen3 symmetric_eigen(const Mat3& symmetric);

/// Affine map x ↦ linear · x + translation. Maps are named to_from: `world_from_index` takes an
/// index to a point of the world. The default is the identity.
struct Affine {
    Mat3 linear;
    Vec3d translation;

    constexpr Vec3d operator()(Vec3d point) const { return linear * point + translation; }
    friend constexpr bool operator==(const Affine&, const Affine&) = default;
};
/// Inverse map; infinities or NaN where the linear part is singular.
constexpr Affine inverse(const Affine& a) {
    const Mat3 linear = inverse(a.linear);
    return {linear, -(linear * a.translation)};
}

/// Axis-aligned box from corner `lower` to corner `upper`. The default is empty: lower > upper, and
/// the first include() replaces it.
struct Box {
    Vec3d lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                std::numeric_limits<double>::infinity()};
    Vec3d upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                -std::numeric_limits<double>::infinity()};

    bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
    Vec3d center() const { return 0.5 * (lower + upper); }
    /// Bounding radius: half the diagonal.
    double radius() const { return 0.5 * length(upper - lower); }
    /// Grows the box to hold a point.
    void include(Vec3d point) {
        for (int axis = 0; axis < 3; ++axis) {
            lower[axis] = std::fmin(lower[axis], point[axis]);
            upper[axis] = std::fmax(upper[axis], point[axis]);
        }
    }
    /// Grows the box to hold another one; an empty one changes nothing.
    void include(const Box& other) {
        if (other.empty()) return;
        include(other.lower);
        include(other.upper);
    }
    friend bool operator==(const Box&, const Box&) = default;
};

/// The box moved by a vector; an empty one stays empty.
inline Box moved(const Box& box, Vec3d by) { return {box.lower + by, box.upper + by}; }
/// Axis-aligned box around the eight mapped corners of `box`; empty for an empty box.
Box transformed(const Affine& map, const Box& box);

}  // namespace vog
