// cell_fields.h: fields of a model whose Gaussians are the cells of a uniform cut, in one pass over the voxels.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "convert/fields/field_entries.h"
#include "convert/moments/moment_job.h"
#include "vog/convert_moments.h"
#include "vog/progress.h"

namespace vog::joint {

/// A model by a uniform cut of one volume.
struct CutModel {
    UniformCells cells;
    std::size_t gaussians = 0;
    std::optional<Box> period{};  ///< MomentOptions::periodic
};

/// Sets the fields of all Gaussians: each has the voxels of its cell, or of its window by their weights.
/// components  of the layout, at the volume's voxels
/// returns     false, with entries left unfinished, if the volume does not have as many cells as the model
///             Gaussians, as where tiles were divided since its conversion
bool add_by_cells(const Volume& volume, std::span<const Component> components, const Layout& layout,
                  const CutModel& model, const Progress& progress, FieldEntries& entries);

/// The volume's own values as a field of its uniform cells of at most a leaf's edge, summed while the conversion
/// makes them: the same as by add_by_cells, without a pass of its own.
class OwnCellFields {
  public:
    /// name  of the field
    /// The volume must outlive the object.
    OwnCellFields(const Volume& volume, const std::string& name, int block_voxels,
                  bool overlapping);
    ~OwnCellFields();
    /// For MomentJob::receiver; must not outlive the object.
    moments::CellReceiver receiver();
    /// Adds the field to the model of these cells.
    void move_to(Gaussians& model) &&;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace vog::joint
