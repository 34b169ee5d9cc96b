// vog/gaussians.h: the model, N truncated 3D Gaussians in world space, as plain arrays.
//
//   sigma(x) = sum_i density_i * exp(-1/2 |W_i d_i|^2), for |W_i d_i| <= cutoff
//   d_i = x - (origin + mean_i)
//   W_i = diag(1 / scale_i) * R_i^T
//   R_i = rotation matrix of rotation_i
//
// sigma is density per world unit of length: its integral along a ray, times the extinction (a
// factor chosen at render time), is the optical depth T. The truncated Gaussian is the kernel: mass
// and variance are those after the cut. docs/method.md compares these conventions with those of the
// paper, of 3DGS and of volprim.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "vog/fields.h"
#include "vog/linear.h"
#include "vog/memory.h"
#include "vog/subject.h"

namespace vog {

/// Model of N Gaussians. BigVector (vog/memory.h): a std::vector that may exceed main memory.
struct Gaussians {
    /// Point of the world that means are relative to, world units. Means are floats, 24 bits: far
    /// from 0 they would lose the digits that tell voxels apart. 0 for data near 0 (model_origin).
    Vec3d origin;
    BigVector<Vec3f> mean;     ///< [N] centres minus origin, world units
    BigVector<Vec3f> scale;    ///< [N] standard deviations along the own axes, world units, > 0
    BigVector<Quat> rotation;  ///< [N] from own axes to world axes; empty: no Gaussian is rotated
    BigVector<float> density;  ///< [N] peak density, per world unit, >= 0
    Fields fields;             ///< [N] each; none: only density

    float cutoff = 2.25f;  ///< radius of the support, standard deviations, (0, 8]

    /// Box of the source data, world units, not relative to the origin: source and model get the
    /// same views by it.
    Box box;
    Content content;                  ///< Part of the source data that is shown
    std::uint64_t source_voxels = 0;  ///< active voxels or particles of the source; 0: unknown
    std::string source;               ///< name of the source data: "smoke.vdb density"
    std::string method;               ///< name of the conversion: "paper", "moments", ...
    std::string options;              ///< options of the conversion, as flags of `vog convert`
    std::string summary;              ///< one line on the result: count, mass ratio, measured error

    std::size_t size() const { return mean.size(); }  ///< N
    /// Whether no Gaussian is rotated.
    bool axis_aligned() const { return rotation.empty(); }
};

/// Origin of a model of data in a box: 0, or, if the box is farther from 0 than 32 times its radius,
/// its centre, rounded to a power of two near the radius.
/// box  world units; an empty one: 0
Vec3d model_origin(const Box& box);
/// Makes means relative to another origin; the Gaussians stay where they are, to one rounding.
/// throws  vog::Error if a rounding exceeds an eighth of its Gaussian's largest scale: floats cannot
///         hold Gaussians that small so far from that origin
void set_origin(Gaussians& gaussians, Vec3d origin);
/// Centre of Gaussian i, world units.
inline Vec3d world_mean(const Gaussians& gaussians, std::size_t i) {
    return gaussians.origin + vec_cast<double>(gaussians.mean[i]);
}

/// Share of a 3D Gaussian's mass inside k = `cutoff` standard deviations, in [0, 1]:
///   P_3(k^2) = erf(k / sqrt 2) - sqrt(2 / pi) k exp(-k^2 / 2);  0.8327 at 2.25
/// (P_n: chi-square distribution function of n degrees of freedom).
double mass_within(double cutoff);
/// Variance of the truncated kernel along an axis, divided by scale^2, in [0, 1]:
///   P_5(k^2) / P_3(k^2);  0.7106 at k = `cutoff` = 2.25.
double variance_within(double cutoff);

/// Cutoff, standard deviations, at which a kernel has fallen to `kappa` of its peak:
/// sqrt(-2 ln kappa). Source: the paper's density threshold kappa.
/// kappa      share of the peak, [1.3e-14, 1); 0: the result is `otherwise`
/// otherwise  standard deviations
/// throws     vog::Error for a kappa out of range
double cutoff_of_kappa(double kappa, double otherwise);

/// Mass of Gaussian i, its integral over space after the cut, density times world volume:
///   density (2 pi)^(3/2) s1 s2 s3 mass_within(cutoff).
double mass(const Gaussians& gaussians, std::size_t i);
/// Mass of the model: the sum over its Gaussians, density times world volume.
double mass(const Gaussians& gaussians);
/// Smallest axis-aligned box around the support of Gaussian i, an ellipsoid; world units.
Box support_box(const Gaussians& gaussians, std::size_t i);
/// Box that views of the model are framed by, world units: gaussians.box, or the union of the
/// supports if that is empty.
Box view_box(const Gaussians& gaussians);
/// Whitening matrix W of Gaussian i, per world unit: |W (x - world_mean)| is the distance of x in
/// standard deviations.
Mat3 whitening(const Gaussians& gaussians, std::size_t i);

/// Appends `other`. The result has rotations if either has; boxes are united, source_voxels added,
/// texts that differ joined by " + ". Models of different origins get the model_origin of both.
/// throws  vog::Error if the cutoffs or the units of length differ, or as set_origin does for models too far apart
void append(Gaussians& gaussians, const Gaussians& other);
/// Copies some Gaussians, with the model's origin, cutoff, box, source, method and options.
/// index   places in the model, [0, N), in the order of the result; repeats are allowed
/// throws  vog::Error for an index of N or more
[[nodiscard]] Gaussians select(const Gaussians& gaussians, std::span<const std::size_t> index);
/// Checks the lengths of the arrays and the ranges given above.
/// throws  vog::Error naming `gaussians.source` and the first offending Gaussian
void validate(const Gaussians& gaussians);

}  // namespace vog
