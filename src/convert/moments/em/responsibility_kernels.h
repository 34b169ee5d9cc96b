// responsibility_kernels.h: the inner loops of soft cells, compiled once for every SIMD target
// (Highway) and
// chosen at run time: a Gaussian's values at the points of a brick, and what its shares sum up to.
// No fused multiplications, and sums that do not depend on the width: the same bytes on every
// target.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "convert/moments/gaussian_moments.h"

namespace vog::moments {

/// Gaussians reach this many standard deviations: at 2.65 or 3.75 models are 0.5 to 2 dB worse.
inline constexpr double kShareReach = 3;

/// Points come in runs of 16: two rows of eight along z, as a leaf stores its voxels.
inline constexpr int kRun = 16;

/// A Gaussian over a lattice of 8^3 points: where it lies, and the runs it reaches.
struct RunKernel {
    float dx = 0, dy = 0, dz = 0;  ///< first point minus mean
    float step = 1;                ///< from point to point
    /// u = xx x² + xy x y + ... of a point: a 32nd of its squared distance in standard deviations.
    float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    float peak = 0;                        ///< value: peak exp(-16 u)
    int x0 = 0, x1 = -1, y0 = 0, y1 = -1;  ///< inclusive; y in pairs of rows
    std::size_t first_run = 0;             ///< of its values

    std::size_t run_count() const {
        return x1 < x0 || y1 < y0 ? 0 : static_cast<std::size_t>((x1 - x0 + 1) * (y1 - y0 + 1));
    }
};

/// 512 floats by leaf_offset.
using BrickFloats = std::array<float, kLeafVoxels>;

/// Writes each Gaussian's values and adds them to the sum of all; both aligned to 64 bytes.
void add_values(std::span<const RunKernel> kernels, float* values, BrickFloats& sum);
/// A point is reached where the sum is more than this share of its mass, the largest peak being 1:
/// below, mass over sum could overflow.
inline constexpr float kLeastSum = 1e-30f;
/// From sums to weights, mass over sum, where a point's mass is value times volume.
/// returns  whether there is a point with mass that no Gaussian reaches: its weight is 0
bool weights_of(const float* value, float volume, BrickFloats& sum);
/// Adds to parts[i], about its mean, what Gaussian i takes: value times weight of each point.
void take_shares(std::span<const RunKernel> kernels, const float* values, const BrickFloats& weight,
                 std::span<MomentSums> parts);

}  // namespace vog::moments
