// levels_field.h: Values of a level's neighbour voxels beyond its edge, for trilinear interpolation.
#pragma once

#include "vog/levels.h"

namespace vog::reference {

/// The level with one layer of voxels around its active ones, so that interpolation within it does
/// not fall to 0 at a seam. A voxel of the layer has the value of the composite of all levels at its
/// centre, or, where no level is active, the mean of the level's voxels that touch it.
Volume extended_field(const Levels& levels, std::size_t level);

}  // namespace vog::reference
