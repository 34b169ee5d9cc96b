// splat_boxes.h: Splatting with the paper's bounding boxes: a ray counts a Gaussian only if it meets
// the Gaussian's box.
#pragma once

#include "render/splat/near/near_splats.h"
#include "vog/image.h"
#include "vog/progress.h"

namespace vog::splat {

/// Draws T per pixel at extinction 1. The paper's pipeline tests rays against the boxes first; boxes
/// smaller than the kernel's support cut it to the silhouette of the box.
/// clip        of the picture, with its model and frame; a box counts if the part of the ray that stays meets it
/// aabb_sigma  half edges of the boxes in the paper's radii r = scale sqrt(2), clipped to the scene's
///             box; for a rotated Gaussian, the box around the ellipsoid of those radii
/// progress  called with the fraction of the Gaussians drawn, after each batch
/// image       of the frame's size, overwritten
void render_boxes(const SplatKernels& kernels, const KernelPolynomial& kernel,
                  const SplatClip& clip, double aabb_sigma, const Progress& progress,
                  DepthImage& image);

}  // namespace vog::splat
