// reference_linear.h: Line integral of the trilinear field between voxel centres.
#pragma once

#include "render/reference/hierarchical_dda.h"
#include "render/reference/reference.h"
#include "render/reference/reference_grid.h"

namespace vog::reference {

/// Integral of the field over t >= 0, in units of t, within a segment.
/// grid  with a tree made by nano_tree(volume, true)
/// ray   VoxelGrid::Data::center_ray: voxel centres at whole numbers
double linear_sum(const VoxelGrid::Data& grid, const GridRay& ray, Segment within = {});

}  // namespace vog::reference
