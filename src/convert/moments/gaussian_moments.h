// gaussian_moments.h: mass, first and second moments of voxels as boxes, and the Gaussian that has them.
// Index space throughout: lengths in voxels, mass in density times voxels.
#pragma once

#include <array>
#include <span>

#include "core/morton.h"
#include "vog/convert_moments.h"
#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::moments {

/// Sums over voxels about a point that the owner states, usually the centre of a cell.
struct MomentSums {
    double mass = 0;
    Vec3d first;
    std::array<double, 6> second{};  ///< xx xy xz yy yz zz, the boxes' own variance included
};

/// A mass distribution up to its second moments.
struct Moments {
    double mass = 0;
    Vec3d mean;
    std::array<double, 6> covariance{};  ///< xx xy xz yy yz zz
};

/// Variance of a box of unit edge: what a voxel has by itself.
inline constexpr double kBoxVariance = 1.0 / 12;

/// Adds sums about a point that lies at `offset` from the point of `to`.
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

/// A cube of constant density about its centre: `mass` of all its voxels.
inline MomentSums cube_sums(double mass, double edge) {
    const double second = mass * kBoxVariance * edge * edge;
    return {mass, {}, {second, 0, 0, second, 0, second}};
}

/// Mean and covariance about the same point; mass must not be zero.
Moments moments_of(const MomentSums& sums);
/// Moments of the sum, at least one with mass.
Moments joined_moments(std::span<const Moments> parts);
MomentSums sums_of(const Moments& moments);

/// Sums about the centre of each cube of a leaf, cubes in Morton order (x the most significant).
template <int edge>
using LeafSums = std::array<MomentSums, (8 / edge) * (8 / edge) * (8 / edge)>;
/// The 64 cubes of 2^3 voxels.
LeafSums<2> leaf_sums(const Leaf& leaf);
/// Eight neighbours to one; `edge` of the smaller cubes.
template <int edge>
LeafSums<2 * edge> merge_eight(const LeafSums<edge>& fine);

/// What a moment Gaussian needs besides its moments.
struct MomentFrame {
    Affine world_from_index;
    double voxel_volume = 1;
    bool axis_aligned = false;
    double spread = 1;
    double widening2 = 1;       ///< kernel variance per variance of the mass it replaces: P3/P5
    double density_factor = 1;  ///< 1 / ((2 pi)^(3/2) P3)
};
/// cutoff  of the model that the Gaussians are for
MomentFrame moment_frame(const Affine& world_from_index, bool axis_aligned, double spread,
                         double cutoff = kMomentCutoff);

/// Writes Gaussian i: mass, mean and covariance as given, after the cut. `moments.mean` is an
/// index.
void set_gaussian(Gaussians& model, std::size_t i, const Moments& moments,
                  const MomentFrame& frame);
/// Covariance of Gaussian i's kernel before the cut, in world units: xx xy xz yy yz zz.
std::array<double, 6> kernel_covariance(const Gaussians& model, std::size_t i);
/// Arrays for `count` Gaussians.
void resize(Gaussians& model, std::size_t count, bool axis_aligned);

}  // namespace vog::moments
