// slice.h: Densities and fields on a plane: where each ray of a picture meets it.
#pragma once

#include <limits>
#include <span>

#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/field_maps.h"
#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/progress.h"
#include "vog/voxel_field.h"

namespace vog {

struct SliceOptions {
    ClipPlane plane;      ///< dot(normal, x) = offset
    Clipping clip{};      ///< space that counts
    int samples = 1;      ///< N: a pixel is the mean over N x N points, [1, 64]
    double kappa = 0;     ///< cutoff of Gaussians (cutoff_of_kappa)
    Progress progress{};  ///< called with the finished fraction
    /// Of a model: means are the value with the largest density, not between several.
    bool labels = false;
};

/// Density of an active voxel of density 0, whose field counts where nothing else does.
inline constexpr float kLeastDensity = std::numeric_limits<float>::min();

/// A model on a plane: sum w_i and, of a field, sum w_i phi_i / sum w_i, with w_i the density of Gaussian i at the point and phi_i its plane
/// there (vog/fields.h). Points are sampled: Gaussians smaller than a pixel may lie between them.
/// choice   without a field: the density alone, and means of 0
/// returns  column: the density; mean and deviation NaN where there is none. The same bytes for any number of threads
/// throws   vog::Error for a field that the model lacks, and an unusable camera, size or clip
/// cost     O(Gaussians + pixels of the ellipses in which the plane cuts them)
[[nodiscard]] FieldMaps slice_model(const Gaussians& gaussians, const FieldChoice& choice,
                                    const Camera& camera, int width, int height,
                                    const SliceOptions& options);

/// Voxels on a plane, constant in each: volumes add up, weighted by density; of levels of a mesh the finest that is active counts.
/// fields  [volumes.volumes] at the voxels of each; none: the density alone, and means of 0
/// part    shown of the fields
/// returns and throws as slice_model; where all active voxels have density 0, column is kLeastDensity
[[nodiscard]] FieldMaps slice_voxels(std::span<const VolumeSet* const> sets,
                                     std::span<const std::span<const VoxelField>> fields,
                                     FieldPart part, const Camera& camera, int width, int height,
                                     const SliceOptions& options);

}  // namespace vog
