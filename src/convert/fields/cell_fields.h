// cell_fields.h: fields of a model whose Gaussians are the cells of a uniform cut, in one pass over the voxels.
#pragma once

#include <cstddef>
#include <span>

#include "convert/fields/field_entries.h"
#include "vog/convert_moments.h"
#include "vog/progress.h"

namespace vog::joint {

/// A model by a uniform cut of one volume.
struct CutModel {
    UniformCells cells;
    std::size_t gaussians = 0;
};

/// Sets the fields of all Gaussians: each has the voxels of its cell, or of its window by their weights.
/// components  of the layout, at the volume's voxels
/// returns     false, with entries left unfinished, if the volume does not have as many cells as the model
///             Gaussians, as where tiles were divided since its conversion
bool add_by_cells(const Volume& volume, std::span<const Component> components, const Layout& layout,
                  const CutModel& model, const Progress& progress, FieldEntries& entries);

}  // namespace vog::joint
