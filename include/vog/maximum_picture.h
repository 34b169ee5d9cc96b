// vog/maximum_picture.h: maximum intensity projection: the largest value of a scalar field along each ray
// (docs/volume_rendering.md, "Maximum intensity").
#pragma once

#include <span>
#include <string>

#include "vog/quantity.h"
#include "vog/volume_picture.h"

namespace vog {

/// Default of slabs in a maximum: means over thick ones are lower than the largest within.
inline constexpr int kMaximumSlabs = 128;
/// Means count where the Gaussians' density is at least this share of the largest on the ray: less has the error of the
/// splats' polynomials.
inline constexpr double kLeastDensityShare = 1e-3;

/// Largest conditional mean of a model's field along the ray through each pixel,
///   max over t of  sum d_i phi_i / sum d_i,   d_i density of Gaussian i at t, phi_i the plane of its field there
/// as means over depth slabs. Within the field's range.
/// options  its light has no effect
/// returns  NaN where there is no Gaussian; the same bytes for any number of threads
/// throws   vog::Error as SlabRenderer does
[[nodiscard]] ValueMap render_maximum_splat(const Gaussians& gaussians, const std::string& field,
                                            const Camera& camera, int width, int height,
                                            const SlabOptions& options = {.slabs = kMaximumSlabs});
/// The same in steps of an eighth of the thinnest Gaussian on the ray: the truth of the slabs.
/// throws  vog::Error as render_volume_trace does
[[nodiscard]] ValueMap render_maximum_trace(const Gaussians& gaussians, const std::string& field,
                                            const Camera& camera, int width, int height,
                                            const TraceOptions& options = {},
                                            const TraceSceneOptions& scene = {},
                                            const Clipping& clip = {});
/// Largest value of the voxels on the ray through each pixel, exactly: constant in each voxel, all active voxels.
/// volumes  as of render_volume_reference
/// options  samples: mean over those rays of a pixel that meet voxels
/// returns  NaN where a pixel meets no active voxel
/// throws   vog::Error as render_volume_reference does
[[nodiscard]] ValueMap render_maximum_reference(std::span<const Volume> volumes,
                                                std::span<const VoxelField> fields,
                                                const Camera& camera, int width, int height,
                                                const ReferenceOptions& options = {});

}  // namespace vog
