// brick_responsibilities.h: what soft cells take of one brick.
#pragma once

#include <hwy/aligned_allocator.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "convert/moments/cells/bricks.h"
#include "convert/moments/em/responsibility_kernels.h"

namespace vog::moments {

/// A cell's Gaussian, ready for samples. Larger than a cell: made anew for each brick.
struct CellKernel {
    Vec3d mean, reach;                    ///< half extents of the box it reaches
    std::array<float, 6> half_inverse{};  ///< half the inverse covariance
    double peak = 0;                      ///< in units that all kernels share
    double thinnest = 0;                  ///< least variance along an axis
};
CellKernel kernel_of(const Moments& cell);
Vec3d reach_of(const Moments& cell);

/// What a thread needs for a brick.
struct BrickScratch {
    std::vector<CellKernel> kernels;  ///< of those that reach the brick
    std::vector<RunKernel> runs;
    hwy::AlignedFreeUniquePtr<float[]> values;
    std::size_t capacity = 0;  ///< runs of values
    alignas(64) BrickFloats sum;
    BrickFloats tile;  ///< values, where there is no leaf
};

/// What each of the scratch's kernels takes of one brick: added to parts[i], about its mean.
/// kernels  with peaks of at most 1
void share_brick(const Brick& brick, BrickScratch& scratch, std::span<MomentSums> parts);

}  // namespace vog::moments
