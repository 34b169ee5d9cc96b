// responsibility_kernels.h: SIMD loops of the E step: values of Gaussians on a brick's samples,
// sums of responsibilities.
// Compiled for every SIMD target and chosen at run time (Highway). Without fused multiplications,
// and with sums in an order that does not depend on the vector width: the same bytes on every
// target.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "convert/moments/gaussian_moments.h"

namespace vog::moments {

/// Radius of a Gaussian's support, standard deviations. At 2.65 or 3.75 models are 0.5 to 2 dB
/// worse.
inline constexpr double kSupportDeviations = 3;

/// Points per run: two rows of eight along z, contiguous in a leaf.
inline constexpr int kRun = 16;

/// A Gaussian relative to a lattice of 8^3 points, and the runs that its support overlaps.
struct RunKernel {
    float dx = 0, dy = 0, dz = 0;  ///< first point minus mean
    float step = 1;                ///< between points, voxels
    /// u = xx x² + xy x y + ..., with x y z relative to the mean: Mahalanobis distance squared /
    /// 32.
    float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    float peak = 0;                        ///< the value is peak exp(-16 u)
    int x0 = 0, x1 = -1, y0 = 0, y1 = -1;  ///< inclusive; y counts pairs of rows
    std::size_t first_run = 0;             ///< in `values`, runs

    std::size_t run_count() const {
        return x1 < x0 || y1 < y0 ? 0 : static_cast<std::size_t>((x1 - x0 + 1) * (y1 - y0 + 1));
    }
};

/// One float for each point, indexed by leaf_offset.
using BrickFloats = std::array<float, kLeafVoxels>;

/// Evaluates each Gaussian and adds its values to the sum of the mixture.
/// values  out: kRun floats for each run, from first_run on; aligned to 64 bytes
/// sum     aligned to 64 bytes
void add_values(std::span<const RunKernel> kernels, float* values, BrickFloats& sum);
/// A point counts as covered where sum / mass exceeds this, with peaks of at most 1. Below, mass /
/// sum could overflow.
inline constexpr float kLeastSum = 1e-30f;
/// Replaces sums by weights, mass / sum, where the mass of a point is value times volume.
/// returns  whether any point with mass is not covered; its weight is 0
bool responsibility_weights(const float* value, float volume, BrickFloats& sum);
/// Adds to parts[i], about its mean, the moments of Gaussian i's part: at each point its value
/// times the weight.
void add_responsibilities(std::span<const RunKernel> kernels, const float* values,
                          const BrickFloats& weight, std::span<MomentSums> parts);

}  // namespace vog::moments
