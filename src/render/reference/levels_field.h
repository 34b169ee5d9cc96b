// levels_field.h: what trilinear interpolation sees beyond the edge of a level.
#pragma once

#include "vog/levels.h"

namespace vog::reference {

/// The level with a layer of voxels around its active ones, so that interpolation in its own voxels
/// does not fall to 0 at a seam: each has the value that the levels have at its centre, or, where
/// none is, the mean of the level's voxels that touch it.
Volume extended_field(const Levels& levels, std::size_t level);

}  // namespace vog::reference
