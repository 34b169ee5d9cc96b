// small_gaussians.h: Gaussians smaller than a pixel in a ray tracer's picture (docs/method.md).
// A ray through a pixel's centre does not give their mean over the pixel: the thinnest are left to
// the splat, and the others count with a share that makes their sum over the pixels their mass.
#pragma once

#include <vector>

#include "render/device/tile_splat.h"
#include "render/trace/trace_model.h"
#include "vog/image.h"

namespace vog::trace {

struct SmallGaussians {
    /// [N] factor on the tau of each Gaussian along rays; 0: splatted. Empty: all 1.
    std::vector<float> shares;
    std::vector<device::TileSplat> splats;  ///< of those with share 0, in the model's order
};

/// Finds the small Gaussians of a picture. Without effect in a boxed model: the paper's boxes are met
/// by single rays.
SmallGaussians small_gaussians(const TraceModel& model, const device::Camera& camera);

/// Adds the splats' T, in units of TraceModel::depth_unit, to an image; the same bytes for any number of threads.
void draw_splats(const std::vector<device::TileSplat>& splats, const device::Kernel& kernel,
                 const device::Camera& camera, DepthImage& image);

}  // namespace vog::trace
