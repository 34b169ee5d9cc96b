// moment_uniform.h: hard cells of one size.
#pragma once

#include "convert/moment_field.h"
#include "convert/packed_cells.h"

namespace vog {

/// block    edge of a cell, a power of two: voxels of each level up to a leaf's edge, then voxels
///          of the coarsest
/// returns  cells with mass, in the order of the bricks or of the octree
PackedCells uniform_cells(const MomentField& field, int block);

}  // namespace vog
