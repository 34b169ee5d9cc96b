// cell_model.h: A Gaussian for each cell with mass, with its fields.
#pragma once

#include <memory>

#include "vog/gaussians.h"
#include "vog/scene.h"

namespace vog {

struct CellModel {
    Gaussians model;    ///< with content, source and units
    CellSource source;  ///< Gaussian i is that of cell source.kept[i]
    CellNotes notes;
    double mass = 0;  ///< of all cells
};
/// own_field      carries the density itself as a field
/// clip_negative  counts negative densities as 0
/// throws         vog::Error as convert_cells does
CellModel cell_model(std::shared_ptr<const Cells> cells, bool own_field, bool clip_negative);

}  // namespace vog
