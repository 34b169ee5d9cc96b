// device_twin.h: the CUDA tile renderer on the CPU, from its device header compiled for the host.
#pragma once

#include "render/splat/splat.h"

namespace vog::test {

/// T by the device code of cuda_splat.cu, pixel by pixel.
DepthImage render_tile_splat_twin(const Gaussians& model, const Camera& camera, int width,
                                  int height);

}  // namespace vog::test
