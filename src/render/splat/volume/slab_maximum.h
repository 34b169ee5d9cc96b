// slab_maximum.h: Maximum intensity projection and optical depth by depth slabs.
#pragma once

#include "render/splat/volume/slab_kernels.h"

namespace vog::splat {

/// Largest mean over slabs of light made by value_planes (render/by_value/value_light.h): red, with alpha 1 where
/// there is one. Sets SlabCell::seen.
void maximum_cell(SlabCell& cell);

/// T over all slabs, red, of light of alpha 1. Sets SlabCell::seen.
void depth_cell(SlabCell& cell, const CameraFrame& frame);

}  // namespace vog::splat
