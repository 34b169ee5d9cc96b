// split_gain.h: gain of replacing one Gaussian by the two of its parts, in closed form.
#pragma once

#include "convert/moments/gaussian_moments.h"

namespace vog::moments {

/// Power p of the cell's own column depth that gains are divided by.
enum class DepthPower {
    three_quarters,  ///< 0.75: the only account of depth
    quarter,         ///< 0.25: for gains that are multiplied by VisibilityWeight as well
};

/// Squared L2 distance between one Gaussian and its two parts, untruncated, times edge^2.5, divided
/// by column depth to the power p. The edge is that of the cube with the variance of `whole`, the
/// depth mass / edge^2. Without the division the densest columns get every split.
/// a, b      parts of `whole`, both with mass
/// variance  of carried fields between the parts, in units of their variance over the whole data: adds the squared L2
///           norm of the Gaussian times this share, the squared error of density times value that a split removes
/// returns   >= 0, finite
double split_gain(const Moments& whole, const Moments& a, const Moments& b, DepthPower power,
                  double variance = 0);

/// Factor from gains in voxels to gains in the unit of `voxel_edge`.
double gain_scale(double voxel_edge, DepthPower power);

}  // namespace vog::moments
