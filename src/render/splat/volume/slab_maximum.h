// slab_maximum.h: Maximum intensity projection by depth slabs.
#pragma once

#include "render/splat/volume/slab_kernels.h"

namespace vog::splat {

/// Largest mean over slabs: red, a share of the field's range, with alpha 1 where there is one. Sets SlabCell::seen.
void maximum_cell(float most_share, SlabCell& cell);

}  // namespace vog::splat
