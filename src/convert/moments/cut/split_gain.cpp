// split_gain.cpp: inner products of Gaussians, and the squared distance they add up to.
#include "convert/moments/cut/split_gain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "convert/moments/covariance_adjugate.h"

namespace vog::moments {

namespace {

constexpr double kTwoPiCubed = 8 * std::numbers::pi * std::numbers::pi * std::numbers::pi;

/// Inner product of two untruncated Gaussians of unit mass: N(mean_a - mean_b; 0, C_a + C_b).
double overlap(const Moments& a, const Moments& b) {
    std::array<double, 6> c;
    for (std::size_t n = 0; n < 6; ++n) c[n] = a.covariance[n] + b.covariance[n];
    const auto [adjugate, det] = adjugate_of(c);
    const auto [xx, xy, xz, yy, yz, zz] = adjugate;
    const Vec3d d = a.mean - b.mean;
    const double distance2 = (xx * d.x * d.x + yy * d.y * d.y + zz * d.z * d.z +
                              2 * (xy * d.x * d.y + xz * d.x * d.z + yz * d.y * d.z)) /
                             det;
    return std::exp(-0.5 * distance2) / std::sqrt(kTwoPiCubed * det);
}

/// Inner product of a Gaussian of unit mass with itself.
double overlap(const Moments& a) {
    return 1 / std::sqrt(8 * kTwoPiCubed * adjugate_of(a.covariance).determinant);
}

/// Power of the edge; docs/moments.md has the scan of both powers.
constexpr double kEdgePower = 2.5;

}  // namespace

double split_gain(const Moments& whole, const Moments& a, const Moments& b, DepthPower power,
                  double variance) {
    const double m = whole.mass, norm = m * m * overlap(whole);
    const double squares = norm + a.mass * a.mass * overlap(a) + b.mass * b.mass * overlap(b) +
                           2 * (a.mass * b.mass * overlap(a, b) -
                                m * (a.mass * overlap(whole, a) + b.mass * overlap(whole, b))) +
                           (variance > 0 ? variance * norm : 0);
    // Edge of the cube with the same trace of the covariance, 3 edge^2 / 12.
    const std::array<double, 6>& c = whole.covariance;
    const double edge = 2 * std::sqrt(c[0] + c[3] + c[5]), edge2 = edge * edge;
    const double root = std::sqrt(std::sqrt(m / edge2));  // fourth root of the column depth
    const double column = power == DepthPower::three_quarters ? root * root * root : root;
    const double gain = squares * edge2 * std::sqrt(edge) / column;
    constexpr double kMost = std::numeric_limits<float>::max();
    return gain > 0 ? std::min(gain, kMost) : 0;
}

double gain_scale(double voxel_edge, DepthPower power) {
    // Volume of space, edge^2.5, and column depth to the power.
    return std::pow(voxel_edge,
                    3 + kEdgePower - (power == DepthPower::three_quarters ? 0.75 : 0.25));
}

}  // namespace vog::moments
