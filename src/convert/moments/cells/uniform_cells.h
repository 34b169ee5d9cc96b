// uniform_cells.h: cells of one size, each the voxels of an aligned cube.
#pragma once

#include "convert/moments/cells/lattice_field.h"
#include "convert/moments/cells/packed_cells.h"

namespace vog::moments {

/// block    edge of a cell, a power of two: up to 8 in voxels of each level, above in voxels of the
///          coarsest level
/// returns  cells with mass, in Morton order
PackedCells uniform_cells(const LatticeField& field, int block);

}  // namespace vog::moments
