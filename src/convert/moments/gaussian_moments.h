// gaussian_moments.h: mass, mean and covariance of voxels, and the truncated Gaussian that has
// them.
// Voxels are boxes of constant density. Index space: lengths in voxels, mass in density times
// voxels.
#pragma once

#include <array>
#include <span>
#include <string>

#include "core/morton.h"
#include "vog/convert_moments.h"
#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::moments {

/// Zeroth, first and second moments about a point that the owner states, usually a cell's centre.
/// Additive over disjoint sets of voxels.
struct MomentSums {
    double mass = 0;
    Vec3d first;                     ///< sum of m x
    std::array<double, 6> second{};  ///< sum of m x x^T, xx xy xz yy yz zz; with the boxes' own
};

/// Mass, mean and covariance of a mass distribution.
struct Moments {
    double mass = 0;
    Vec3d mean;
    std::array<double, 6> covariance{};  ///< xx xy xz yy yz zz
};

/// Variance of a box of unit edge, along each axis: that of a single voxel.
inline constexpr double kBoxVariance = 1.0 / 12;

/// Adds sums about another point (parallel axis theorem).
/// offset  from the point of `to` to the point of `from`
inline void add_shifted(MomentSums& to, const MomentSums& from, Vec3d offset) {
    const double m = from.mass;
    const Vec3d f = from.first, o = offset;
    to.mass += m;
    to.first = to.first + f + m * o;
    to.second[0] += from.second[0] + o.x * (2 * f.x + m * o.x);
    to.second[1] += from.second[1] + o.x * f.y + o.y * f.x + m * o.x * o.y;
    to.second[2] += from.second[2] + o.x * f.z + o.z * f.x + m * o.x * o.z;
    to.second[3] += from.second[3] + o.y * (2 * f.y + m * o.y);
    to.second[4] += from.second[4] + o.y * f.z + o.z * f.y + m * o.y * o.z;
    to.second[5] += from.second[5] + o.z * (2 * f.z + m * o.z);
}

/// Sums of a cube of constant density about its centre.
inline MomentSums cube_sums(double mass, double edge) {
    const double second = mass * kBoxVariance * edge * edge;
    return {mass, {}, {second, 0, 0, second, 0, second}};
}

/// Mean relative to the same point, and covariance; the mass must not be 0.
Moments moments_of(const MomentSums& sums);
/// Moments of a sum of distributions, at least one of them with mass.
Moments joined_moments(std::span<const Moments> parts);
MomentSums sums_of(const Moments& moments);

/// Sums of the cubes of `edge` voxels of a leaf, each about its own centre; cubes in Morton order
/// (x the most significant).
template <int edge>
using LeafSums = std::array<MomentSums, (8 / edge) * (8 / edge) * (8 / edge)>;
/// Sums of the 64 cubes of 2^3 voxels.
LeafSums<2> leaf_sums(const Leaf& leaf);
/// Sums of cubes of twice the edge, each from its eight.
template <int edge>
LeafSums<2 * edge> merge_eight(const LeafSums<edge>& fine);

/// Constants that the Gaussians of one model share.
struct MomentFrame {
    Affine world_from_index;  ///< to world coordinates relative to Gaussians::origin
    double voxel_volume = 1;
    bool axis_aligned = false;
    double spread = 1;
    double widening2 = 1;       ///< kernel variance over variance after truncation: P3/P5
    double density_factor = 1;  ///< 1 / ((2 pi)^(3/2) P3)
};
/// spread  factor on each standard deviation at constant mass
/// cutoff  truncation radius, standard deviations
MomentFrame moment_frame(const Affine& world_from_index, bool axis_aligned, double spread,
                         double cutoff = kMomentCutoff);

/// Sets Gaussian i so that after truncation it has these moments, in world units.
/// moments  mean in index space
void set_gaussian(Gaussians& model, std::size_t i, const Moments& moments,
                  const MomentFrame& frame);
/// Covariance of Gaussian i before truncation, world units: xx xy xz yy yz zz.
std::array<double, 6> kernel_covariance(const Gaussians& model, std::size_t i);
/// Resizes the arrays to `count` Gaussians, rotations unless axis-aligned.
void resize(Gaussians& model, std::size_t count, bool axis_aligned);

/// Checks that densities stay within the range of float32, the precision of models.
/// source  name for the message
/// throws  vog::Error if one is infinite, or the largest is below float's smallest normal number
void check_density_range(const Gaussians& model, const std::string& source);

}  // namespace vog::moments
