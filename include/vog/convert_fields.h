// vog/convert_fields.h: fields for the Gaussians of any model, from the voxels or particles it was made of
// (docs/fields.md).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "vog/convert_moments.h"
#include "vog/gaussians.h"
#include "vog/points.h"
#include "vog/progress.h"
#include "vog/voxel_field.h"

namespace vog {

/// Options of add_fields.
struct FieldOptions {
    /// Cells of the model (MomentReport::cells): a voxel counts for the Gaussian of its cell, or for those
    /// of the windows it lies in. None, or of a volume whose tiles were divided since: a voxel's mass is
    /// divided among the Gaussians by their densities there.
    std::optional<UniformCells> cells{};
    Progress progress{};  ///< called with the finished fraction; empty: not
};

/// Adds fields to a model, by the moments of position and value over each Gaussian's part of the voxels.
/// model   of these volumes, by any conversion; Gaussians without a part get the value of the nearest voxels'
///         Gaussian or the mean of the field, and no gradient
/// levels  the measures, as the conversion had them: one volume, or the parts of a mesh
/// fields  [fields][levels] each field at the voxels of each volume; a component with neither leaves nor
///         tiles is the volume's own values
/// throws  vog::Error for a name that the model has already or that is reserved
/// cost    about two steps of expectation-maximisation; of cells a part of their conversion's
void add_fields(Gaussians& model, std::span<const Volume> levels,
                std::span<const std::vector<VoxelField>> fields, const FieldOptions& options = {});

}  // namespace vog
