// splat_boxes.h: the splat with the paper's bounding boxes: a ray counts a Gaussian only if it
// meets the Gaussian's box.
#pragma once

#include "render/splat/splat_kernels.h"
#include "vog/image.h"
#include "vog/progress.h"

namespace vog::splat {

/// T per pixel at extinction 1. In the paper's pipeline the boxes are what rays are tested against
/// first; where they are smaller than the kernel's support they cut it to silhouettes of boxes.
/// aabb_sigma  of the paper's radii r = scale sqrt(2): boxes reach from mean - sigma r to mean +
///             sigma r, within the box of the scene; of a rotated Gaussian, the box around the
///             ellipsoid of those radii
/// progress  called with the fraction of the Gaussians drawn, after each batch
/// image       of the frame's size, overwritten
void render_boxes(const SplatKernels& kernels, const SplatModel& model,
                  const KernelPolynomial& kernel, const CameraFrame& frame, double aabb_sigma,
                  const Progress& progress, DepthImage& image);

}  // namespace vog::splat
