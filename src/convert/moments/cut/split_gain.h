// split_gain.h: what it is worth to split a cell in two.
#pragma once

#include "convert/moments/gaussian_moments.h"

namespace vog::moments {

/// What an error is measured against.
enum class ColumnDepth {
    own,   ///< the depth of the cell itself, to the power 0.75
    seen,  ///< that to the power 0.25, for gains to be multiplied with what is seen there
};

/// |G_whole - G_a - G_b|^2 in closed form, for untruncated kernels, times the edge of the cell to
/// the power 2.5, over its depth: an error in space is seen through the edge, along the column.
/// Without the division the densest columns get everything.
/// a, b     the two parts of `whole`, both with mass
/// returns  >= 0, finite
double split_gain(const Moments& whole, const Moments& a, const Moments& b, ColumnDepth depth);

/// What a gain in voxels of this edge is to be multiplied with, to be in units of the edge's.
double gain_scale(double voxel_edge, ColumnDepth depth);

}  // namespace vog::moments
