// nvdb_grid.h: a NanoVDB grid of any type as an OpenVDB grid, its every pointer checked.
#pragma once

#include <openvdb/openvdb.h>

#include <string>

#include "core/aligned_buffer.h"
#include "io/vdb/vdb_density.h"
#include "vog/linear.h"
#include "vog/volume.h"

namespace vog::nvdb {

using namespace vdb;

/// Can be density without being asked for by name.
bool is_scalar(nanovdb::GridType type);

/// Leaves of a grid as a volume has them, those without active voxels left out, and what was found
/// in them.
struct NanoLeaves {
    BigVector<Leaf> leaves;
    Census census;
};

/// Values, active states, tiles, background and class; not the transform. Quantised values come as
/// floats.
/// grid    with a sound header (NvdbFile::load)
/// where   what messages start with
/// leaves  takes the leaves, of which the grid then has none; null: they are the grid's
/// throws  vog::Error for a type that holds neither numbers nor vectors, for nodes that reach out
///         of the buffer or overlap, for a checksum that does not match
openvdb::GridBase::Ptr grid_from_nano(const NanoBuffer& grid, const std::string& where,
                                      NanoLeaves* leaves = nullptr);

/// The map of the grid's header, which may be singular.
Affine nano_transform(const NanoBuffer& grid);

}  // namespace vog::nvdb
