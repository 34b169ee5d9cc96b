// uniform_cells.h: hard cells of one size.
#pragma once

#include "convert/moments/cells/lattice_field.h"
#include "convert/moments/cells/packed_cells.h"

namespace vog::moments {

/// block    edge of a cell, a power of two: voxels of each level up to a leaf's edge, then voxels
///          of the coarsest
/// returns  cells with mass, in the order of the bricks or of the octree
PackedCells uniform_cells(const LatticeField& field, int block);

}  // namespace vog::moments
