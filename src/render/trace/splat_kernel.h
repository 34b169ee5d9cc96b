// splat_kernel.h: Kernel and pixel limits of a cutoff, for the splats of device code.
#pragma once

#include "render/device/tile_splat.h"

namespace vog::trace {

/// cutoff  k, (0, 8]
device::SplatKernel splat_kernel(double cutoff);

}  // namespace vog::trace
