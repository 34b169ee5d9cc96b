// slab_maximum.h: Maximum intensity projection and optical depth by depth slabs.
#pragma once

#include "render/splat/volume/slab_kernels.h"

namespace vog::splat {

/// Largest mean over slabs of light made by value_planes (render/by_value/value_light.h): red, with alpha 1 where
/// there is one. Sets the sums of the band to 0, as SlabKernels::composite does.
void maximum_band(SlabBand& band, const CameraFrame& frame, Rgba* image);

/// T over all slabs, red, of light of alpha 1; sets the sums of the band to 0.
void depth_band(SlabBand& band, const CameraFrame& frame, Rgba* image);

}  // namespace vog::splat
