// slab_maximum.h: Maximum intensity projection by depth slabs.
#pragma once

#include "render/splat/volume/slab_kernels.h"

namespace vog::splat {

/// Largest mean over slabs of light made by value_planes (render/by_value/value_light.h): red, with alpha 1 where
/// there is one. Sets SlabCell::seen.
void maximum_cell(SlabCell& cell);

}  // namespace vog::splat
