// cuda_model.h: A model packed for splatting on the GPU.
#pragma once

#include <vector>

#include "render/device/tile_splat.h"
#include "vog/gaussians.h"

namespace vog::gpu {

struct CudaModel {
    Vec3d origin;                                  ///< Gaussians::origin, of means and cameras
    std::vector<device::SplatGaussian> gaussians;  ///< scene units
    device::SplatKernel kernel{};
    double unit = 1;  ///< world units of one scene unit: a power of two
};

/// Packs a model.
/// kappa   SplatOptions::kappa
/// throws  vog::Error as trace_scene does
CudaModel cuda_model(const Gaussians& gaussians, double kappa);

}  // namespace vog::gpu
