// cuda_model.h: a model as the GPU's tile renderer takes it.
#pragma once

#include <vector>

#include "render/device/tile_splat.h"
#include "vog/gaussians.h"

namespace vog::gpu {

struct CudaModel {
    std::vector<device::SplatGaussian> gaussians;  ///< scene units
    device::Kernel kernel{};
    double unit = 1;  ///< world units of one scene unit: a power of two
    double cutoff = 0;
};

/// kappa   as in TraceSceneOptions
/// throws  vog::Error as trace_scene does
CudaModel cuda_model(const Gaussians& gaussians, double kappa);

}  // namespace vog::gpu
