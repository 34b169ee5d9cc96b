// brick_responsibilities.h: moments of each Gaussian's part of one brick: the E step on 8^3
// samples.
#pragma once

#include <hwy/aligned_allocator.h>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "convert/moments/cells/bricks.h"
#include "convert/moments/em/responsibility_kernels.h"

namespace vog::moments {

/// A cell's Gaussian as needed to evaluate it. Larger than a cell, so made again for each brick.
struct CellKernel {
    Vec3d mean, half_extent;              ///< index space; half extent of the support's box
    std::array<float, 6> half_inverse{};  ///< half the inverse covariance
    double peak = 0;            ///< mass / sqrt(det C): only ratios between kernels matter
    double least_variance = 0;  ///< along an index axis, voxels squared
};
CellKernel cell_kernel(const Moments& cell);
Vec3d support_half_extent(const Moments& cell);

/// Buffers of one thread, reused from brick to brick.
struct BrickScratch {
    std::vector<CellKernel> kernels;  ///< whose support overlaps the brick
    std::vector<RunKernel> runs;
    hwy::AlignedFreeUniquePtr<float[]> values;
    std::size_t capacity = 0;     ///< length of `values`, in runs of kRun floats
    alignas(64) BrickFloats sum;  ///< sum of all kernels at each sample, then mass / sum
    BrickFloats tile;             ///< values of a tile's samples
};

/// Divides the mass of every sample among scratch.kernels in proportion to their values there, and
/// adds kernel i's part to parts[i], about its mean. A sample outside all supports goes whole to
/// the kernel with the least Mahalanobis distance.
/// scratch  kernels with peaks of at most 1
void add_brick_responsibilities(const Brick& brick, BrickScratch& scratch,
                                std::span<MomentSums> parts);

/// A sample outside all supports, and the kernel that it counts for.
struct UncoveredSample {
    int sample = 0;  ///< leaf_offset
    std::size_t kernel = 0;
};
/// The same division at the centres of the samples, for sums of other quantities: kernel i's share of the mass of
/// a sample is its value in scratch.values, run by run from scratch.runs[i].first_run on, times the weight in
/// scratch.sum.
/// scratch    kernels with peaks of at most 1
/// weigh      changes the values of the kernels at the samples, and scratch.sum to their new sums, before they divide the
///            mass; empty: not
/// uncovered  out
void divide_samples(const Brick& brick, BrickScratch& scratch,
                    const std::function<void(BrickScratch&)>& weigh,
                    std::vector<UncoveredSample>& uncovered);

}  // namespace vog::moments
