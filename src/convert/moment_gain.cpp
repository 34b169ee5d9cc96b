// moment_gain.cpp: what it is worth to split a cell.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "convert/moment_cut.h"

namespace vog {

namespace {

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
    constexpr double kTwoPiCubed = 8 * std::numbers::pi * std::numbers::pi * std::numbers::pi;
    return std::exp(-0.5 * distance2) / std::sqrt(kTwoPiCubed * det);
}

// An error in space is seen through the edge of the cell, along a column of its depth: without
// the division the densest columns get everything. docs/moments.md has the scan of both powers.
constexpr double kEdgePower = 2.5, kDepthPower = 0.75;

}  // namespace

float split_gain(const Moments& parent, std::span<const Moments> children, double edge) {
    if (children.size() < 2) return std::numeric_limits<float>::infinity();
    double squares = parent.mass * parent.mass * overlap(parent, parent);
    for (std::size_t a = 0; a < children.size(); ++a) {
        squares -= 2 * parent.mass * children[a].mass * overlap(parent, children[a]);
        for (std::size_t b = 0; b <= a; ++b)
            squares += (a == b ? 1 : 2) * children[a].mass * children[b].mass *
                       overlap(children[a], children[b]);
    }
    const double column = parent.mass / (edge * edge);
    const double gain = squares * std::pow(edge, kEdgePower) / std::pow(column, kDepthPower) /
                        static_cast<double>(children.size() - 1);
    return static_cast<float>(std::clamp(gain, 0.0, double{std::numeric_limits<float>::max()}));
}

double gain_scale(double voxel_edge) {
    // Squares of densities over space, edge, and column of depth.
    return std::pow(voxel_edge, 3 + kEdgePower - kDepthPower);
}

}  // namespace vog
