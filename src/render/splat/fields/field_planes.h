// field_planes.h: A field along the pixels of a projected Gaussian.
#pragma once

#include "render/shown_field.h"
#include "render/splat/fields/field_kernels.h"

namespace vog::splat {

/// A Gaussian that is drawn wider than it is counts as a point: its field is constant, with its whole variance.
/// frame  relative to Gaussians::origin
/// share  variance_within(k)
PlaneSplat plane_splat(const ShownField& shown, const Gaussians& gaussians,
                       const SplatOrigin& origin, const FarSplat& splat, const CameraFrame& frame,
                       double share);
/// The same for ShownField::along_rays.
ViewSplat view_splat(const ShownField& shown, const Gaussians& gaussians, const SplatOrigin& origin,
                     const FarSplat& splat, const CameraFrame& frame, double share);

/// Adds the three sums of a near splat to the pixels of a tile, by the closed form.
/// rays  of the tile; unused unless the splat is clipped
void add_near_field(const NearSplat& splat, const ShownField& shown, const Gaussians& gaussians,
                    const CameraFrame& frame, double cutoff, const TileRays& rays, FieldTile& tile);

}  // namespace vog::splat
