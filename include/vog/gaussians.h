// vog/gaussians.h: the model. N truncated 3D Gaussians in world space, as plain arrays.
//
//   sigma(x) = sum_i density_i * exp(-1/2 |W_i (x - mean_i)|^2)   where |W_i (x - mean_i)| <= cutoff
//   W_i = diag(1 / scale_i) * R_i^T                               R_i: rotation matrix of rotation_i
//
// Conventions (docs/method.md compares them with the paper's, 3DGS's and volprim's): scales are
// standard deviations in world units, density is the peak per world unit, the kernel is cut at
// `cutoff` standard deviations and the cut is part of the model: mass and spread account for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "vog/linear.h"
#include "vog/memory.h"

namespace vog {

struct Gaussians {
    BigVector<Vec3f> mean;     ///< [N] world units
    BigVector<Vec3f> scale;    ///< [N] standard deviations along the own axes, > 0, world units
    BigVector<Quat> rotation;  ///< [N], or empty: every own axis is a world axis
    BigVector<float> density;  ///< [N] peak, per world unit, >= 0

    float cutoff = 2.25f;  ///< k: support radius in standard deviations, (0, 8]

    Box box;                          ///< of the data the model came from: gives it the same views
    std::uint64_t source_voxels = 0;  ///< active voxels (or points) it stands for; 0: unknown
    std::string source;               ///< "smoke.vdb density"
    std::string method;               ///< "paper", "moments", ...
    std::string options;              ///< what the conversion was asked for, as flags
    std::string summary;              ///< what it reached, in words: mass, measured error

    std::size_t size() const { return mean.size(); }
    bool axis_aligned() const { return rotation.empty(); }
};

/// Share of a 3D Gaussian's mass inside `cutoff` standard deviations, P_3(cutoff^2):
/// erf(k/sqrt 2) - sqrt(2/pi) k exp(-k^2/2). 0.8327 at 2.25.
double mass_within(double cutoff);
/// Share of a 3D Gaussian's variance along an axis that is left by the cut, P_5(k^2) / P_3(k^2):
/// the truncated kernel's own variance is scale^2 times this. 0.7106 at 2.25.
double variance_within(double cutoff);

/// The cutoff at which a kernel has fallen to this share of its peak, sqrt(-2 ln kappa): the
/// paper's kappa. `otherwise` for 0. throws vog::Error if kappa is neither 0 nor in [1.3e-14, 1)
double cutoff_of_kappa(double kappa, double otherwise);

/// Mass of Gaussian i, after truncation: density (2 pi)^(3/2) s1 s2 s3 mass_within(cutoff).
double mass(const Gaussians& gaussians, std::size_t i);
double mass(const Gaussians& gaussians);
/// World box of the truncated support of Gaussian i: tight, also for rotated ellipsoids.
Box support_box(const Gaussians& gaussians, std::size_t i);
/// The box views are taken of: `gaussians.box`, or the union of the supports if that is empty.
Box view_box(const Gaussians& gaussians);
/// Whitening W of Gaussian i: |W (x - mean)| is the distance in standard deviations.
Mat3 whitening(const Gaussians& gaussians, std::size_t i);

/// Appends `other`. Rotations appear when either has them.
/// throws vog::Error if the cutoffs differ
void append(Gaussians& gaussians, const Gaussians& other);
/// The Gaussians of these numbers, in that order; the box stays, so that views do too.
/// throws vog::Error for a number that is not below size()
[[nodiscard]] Gaussians select(const Gaussians& gaussians, std::span<const std::size_t> index);
/// Checks lengths, finiteness, positive scales, non-negative densities, the cutoff.
/// throws vog::Error naming `gaussians.source` and the first offending Gaussian
void validate(const Gaussians& gaussians);

}  // namespace vog
