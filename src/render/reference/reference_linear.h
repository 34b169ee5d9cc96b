// reference_linear.h: line integrals of the trilinear field between voxel centres.
#pragma once

#include "render/reference/hierarchical_dda.h"
#include "render/reference/reference_grid.h"

namespace vog::reference {

/// Integral of the field over t >= 0, in units of t. The grid's tree must have its border.
/// ray  in local coordinates where voxel centres lie at whole numbers
double linear_sum(const VoxelGrid::Data& grid, const GridRay& ray, Segment within = {});

}  // namespace vog::reference
