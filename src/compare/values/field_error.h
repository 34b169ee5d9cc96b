// field_error.h: error of a model's maps of a field over views around the data.
#pragma once

#include <span>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/voxel_field.h"

namespace vog::comparison {

/// Edge of the maps, half of that of the views of T: they take twice the time a pixel.
inline constexpr int kFieldErrorSize_px = 128;

/// Relative L2 of the map of a field's means against the voxels' (FieldDifference::mean_l2), in the worst of the views; of a vector
/// its component along the view.
/// volumes  one, or the parts of a mesh
/// field    [volumes] at their voxels
/// model    with the field, by its name
/// returns  0 where no view shows the field
double field_error(std::span<const Volume> volumes, std::span<const VoxelField> field,
                   const Gaussians& model, std::span<const Camera> views);

}  // namespace vog::comparison
