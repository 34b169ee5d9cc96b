// device_twin.h: the GPU's tile renderer, its device header compiled for the host, pixel by pixel.
#pragma once

#include "vog/splat.h"

namespace vog::test {

DepthImage render_tile_splat_twin(const Gaussians& model, const Camera& camera, int width,
                                  int height);

}  // namespace vog::test
