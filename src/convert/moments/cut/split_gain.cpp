// split_gain.cpp: the product of two Gaussians has a closed form, and so has the square of a
// difference.
#include "convert/moments/cut/split_gain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace vog::moments {

namespace {

constexpr double kTwoPiCubed = 8 * std::numbers::pi * std::numbers::pi * std::numbers::pi;

double determinant(const std::array<double, 6>& c) {
    return c[0] * (c[3] * c[5] - c[4] * c[4]) - c[1] * (c[1] * c[5] - c[4] * c[2]) +
           c[2] * (c[1] * c[4] - c[3] * c[2]);
}

/// Integral of the product of two untruncated Gaussians of unit mass:
/// the density at their distance of the Gaussian with both covariances.
double overlap(const Moments& a, const Moments& b) {
    std::array<double, 6> c;
    for (std::size_t n = 0; n < 6; ++n) c[n] = a.covariance[n] + b.covariance[n];
    // Adjugate over determinant, by rows: xx xy xz yy yz zz.
    const double xx = c[3] * c[5] - c[4] * c[4], xy = c[2] * c[4] - c[1] * c[5],
                 xz = c[1] * c[4] - c[2] * c[3], yy = c[0] * c[5] - c[2] * c[2],
                 yz = c[1] * c[2] - c[0] * c[4], zz = c[0] * c[3] - c[1] * c[1];
    const double det = c[0] * xx + c[1] * xy + c[2] * xz;
    const Vec3d d = a.mean - b.mean;
    const double distance2 = (xx * d.x * d.x + yy * d.y * d.y + zz * d.z * d.z +
                              2 * (xy * d.x * d.y + xz * d.x * d.z + yz * d.y * d.z)) /
                             det;
    return std::exp(-0.5 * distance2) / std::sqrt(kTwoPiCubed * det);
}

/// Of a Gaussian with itself.
double overlap(const Moments& a) {
    return 1 / std::sqrt(8 * kTwoPiCubed * determinant(a.covariance));
}

/// docs/moments.md has the scan of both powers.
constexpr double kEdgePower = 2.5;

}  // namespace

double split_gain(const Moments& whole, const Moments& a, const Moments& b, ColumnDepth depth) {
    const double m = whole.mass;
    const double squares = m * m * overlap(whole) + a.mass * a.mass * overlap(a) +
                           b.mass * b.mass * overlap(b) +
                           2 * (a.mass * b.mass * overlap(a, b) -
                                m * (a.mass * overlap(whole, a) + b.mass * overlap(whole, b)));
    // The edge of the cube with this variance.
    const std::array<double, 6>& c = whole.covariance;
    const double edge = 2 * std::sqrt(c[0] + c[3] + c[5]), edge2 = edge * edge;
    const double root = std::sqrt(std::sqrt(m / edge2));  // of the column's depth, the fourth
    const double column = depth == ColumnDepth::own ? root * root * root : root;
    const double gain = squares * edge2 * std::sqrt(edge) / column;
    constexpr double kMost = std::numeric_limits<float>::max();
    return gain > 0 ? std::min(gain, kMost) : 0;
}

double gain_scale(double voxel_edge, ColumnDepth depth) {
    // Squares of densities over space, edge, and column of depth.
    return std::pow(voxel_edge, 3 + kEdgePower - (depth == ColumnDepth::own ? 0.75 : 0.25));
}

}  // namespace vog::moments
