// field_moments.cpp: sums of joint moments, the plane and the residual that they give.
#include "convert/lod/field_moments.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "convert/moments/covariance_adjugate.h"

namespace vog::lod {

namespace {

/// Nearest float: floats end before doubles do.
float rounded(double value) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(value, -kMost, kMost));
}
Vec3f rounded(Vec3d v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }

Mat3 matrix_of(const std::array<double, 6>& c) {
    return {{Vec3d{c[0], c[1], c[2]}, Vec3d{c[1], c[3], c[4]}, Vec3d{c[2], c[4], c[5]}}};
}

/// Calls visit(n, a, b) for element n of a symmetric matrix of this many components.
template <std::size_t components, class Visit>
void each_pair(const Visit& visit) {
    for (std::size_t a = 0, n = 0; a < components; ++a)
        for (std::size_t b = a; b < components; ++b) visit(n++, a, b);
}

/// Sets what a Gaussian's own plane and residual give: covariances of value and position.
template <std::size_t components>
void set_covariances(FieldMoments<components>& moments, const std::array<double, 6>& kernel) {
    const Mat3 c = matrix_of(kernel);
    for (std::size_t a = 0; a < components; ++a) moments.cross[a] = c * moments.gradient[a];
    each_pair<components>([&](std::size_t n, std::size_t a, std::size_t b) {
        moments.covariance[n] = dot(moments.gradient[a], moments.cross[b]) + moments.residual[n];
    });
}

/// Third moment about the merger's plane: each part's plane lies off it by a normal of mean m and variance s^2.
double third_moment(const Merger& merger, std::span<const ScalarMoments> parts,
                    const ScalarMoments& sum) {
    double third = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const Vec3d d = merger.parts[k].mean - merger.sum.mean;
        const double m = parts[k].value[0] - sum.value[0] - dot(sum.gradient[0], d);
        const Vec3d h = parts[k].gradient[0] - sum.gradient[0];
        const double s2 = dot(h, matrix_of(merger.parts[k].covariance) * h);
        third +=
            merger.share(k) * (m * m * m + 3 * m * (s2 + parts[k].residual[0]) + parts[k].third);
    }
    return third;
}

}  // namespace

ScalarMoments field_moments(const ScalarField& field, std::size_t i,
                            const std::array<double, 6>& kernel) {
    const double deviation = field.deviation[i];
    ScalarMoments moments;
    moments.value[0] = field.value[i];
    moments.gradient[0] = vec_cast<double>(field.gradient[i]);
    moments.residual[0] = deviation * deviation;
    moments.third = double{field.skewness[i]} * deviation * deviation * deviation;
    set_covariances(moments, kernel);
    return moments;
}

VectorMoments field_moments(const VectorField& field, std::size_t i,
                            const std::array<double, 6>& kernel) {
    VectorMoments moments;
    for (std::size_t a = 0; a < 3; ++a) {
        moments.value[a] = field.value[i][static_cast<int>(a)];
        moments.gradient[a] = vec_cast<double>(field.gradient[a][i]);
    }
    std::ranges::copy(field.covariance[i], moments.residual.begin());
    set_covariances(moments, kernel);
    return moments;
}

Merger::Merger(const Moments& sum_of_parts, std::span<const Moments> of)
    : sum(sum_of_parts), parts(of), precision{{Vec3d{}, {}, {}}} {
    // Of a unit near the largest variance, so that tiny worlds do not underflow.
    const std::array<double, 6>& c = sum.covariance;
    const double unit = std::max({c[0], c[3], c[5]});
    if (!(unit > 0) || !std::isfinite(1 / unit)) return;
    std::array<double, 6> scaled = c;
    for (double& element : scaled) element /= unit;
    // No eigenvalue exceeds 3, so that none is flat where the determinant is above this: the inverse, in a tenth of
    // the time of eigenvectors.
    constexpr double kWellConditioned = 1e-6;
    if (const auto [adjugate, det] = adjugate_of(scaled); det > kWellConditioned) {
        precision = matrix_of(adjugate);
        for (Vec3d& row : precision.row) row = (1 / (det * unit)) * row;
        return;
    }
    const Eigen3 eigen = symmetric_eigen(matrix_of(scaled));
    constexpr double kFlat = 1e-10;  // variances below are rounding
    for (int k = 0; k < 3; ++k) {
        if (!(eigen.values[k] > kFlat)) continue;
        const Vec3d axis = eigen.axes.column(k);
        for (int r = 0; r < 3; ++r)
            for (int s = 0; s < 3; ++s)
                precision(r, s) += axis[r] * axis[s] / (eigen.values[k] * unit);
    }
}

template <std::size_t components>
void set_plane(FieldMoments<components>& moments, const Mat3& precision) {
    for (std::size_t a = 0; a < components; ++a)
        moments.gradient[a] = vec_cast<double>(rounded(precision * moments.cross[a]));
    each_pair<components>([&](std::size_t n, std::size_t a, std::size_t b) {
        const double explained = dot(moments.gradient[a], moments.cross[b]);
        moments.residual[n] = moments.covariance[n] - explained;
        if (a == b) moments.residual[n] = std::max(moments.residual[n], 0.0);
    });
}
template void set_plane<1>(ScalarMoments&, const Mat3&);
template void set_plane<3>(VectorMoments&, const Mat3&);

template <std::size_t components>
FieldMoments<components> merged(const Merger& merger,
                                std::span<const FieldMoments<components>> parts) {
    if (parts.size() == 1) return parts.front();
    FieldMoments<components> sum;
    for (std::size_t k = 0; k < parts.size(); ++k)
        for (std::size_t a = 0; a < components; ++a)
            sum.value[a] += merger.share(k) * parts[k].value[a];
    // Second moments about the joint means: squares would cancel.
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const double share = merger.share(k);
        const Vec3d d = merger.parts[k].mean - merger.sum.mean;
        std::array<double, components> off;
        for (std::size_t a = 0; a < components; ++a) {
            off[a] = parts[k].value[a] - sum.value[a];
            sum.cross[a] = sum.cross[a] + share * (parts[k].cross[a] + off[a] * d);
        }
        each_pair<components>([&](std::size_t n, std::size_t a, std::size_t b) {
            sum.covariance[n] += share * (parts[k].covariance[n] + off[a] * off[b]);
        });
    }
    set_plane(sum, merger.precision);
    if constexpr (components == 1) sum.third = third_moment(merger, parts, sum);
    return sum;
}
template ScalarMoments merged<1>(const Merger&, std::span<const ScalarMoments>);
template VectorMoments merged<3>(const Merger&, std::span<const VectorMoments>);

void set_field(ScalarField& field, std::size_t i, const ScalarMoments& moments) {
    constexpr double kMostSkewness = 3;
    const double deviation = std::sqrt(moments.residual[0]);
    const double cube = deviation * moments.residual[0];
    field.value[i] = rounded(moments.value[0]);
    field.gradient[i] = rounded(moments.gradient[0]);
    field.deviation[i] = rounded(deviation);
    field.skewness[i] =
        cube > 0 ? rounded(std::clamp(moments.third / cube, -kMostSkewness, kMostSkewness)) : 0;
}

void set_field(VectorField& field, std::size_t i, const VectorMoments& moments) {
    field.value[i] = rounded(Vec3d{moments.value[0], moments.value[1], moments.value[2]});
    for (std::size_t a = 0; a < 3; ++a) field.gradient[a][i] = rounded(moments.gradient[a]);
    for (std::size_t n = 0; n < 6; ++n) field.covariance[i][n] = rounded(moments.residual[n]);
}

}  // namespace vog::lod
