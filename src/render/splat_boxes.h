// splat_boxes.h: the splat with the paper's bounding boxes: a ray counts a Gaussian only if it
// meets the Gaussian's box.
#pragma once

#include "render/splat_kernels.h"
#include "vog/image.h"

namespace vog {

/// T per pixel at extinction 1. In the paper's pipeline the boxes are what rays are tested against
/// first; where they are smaller than the kernel's support they cut it to silhouettes of boxes.
/// aabb_sigma  of the paper's radii r = scale sqrt(2): boxes reach from mean - sigma r to mean +
///             sigma r, within the box of the scene; of a rotated Gaussian, the box around the
///             ellipsoid of those radii
DepthImage render_boxes(const SplatKernels& kernels, const Gaussians& gaussians,
                        const CameraFrame& frame, double aabb_sigma);

}  // namespace vog
