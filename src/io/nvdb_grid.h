// nvdb_grid.h: a NanoVDB grid of any type as an OpenVDB grid, its every pointer checked.
#pragma once

#include <openvdb/openvdb.h>

#include <string>

#include "io/nano_buffer.h"
#include "vog/linear.h"

namespace vog {

/// Can be density without being asked for by name.
bool is_scalar(nanovdb::GridType type);

/// Values, active states, tiles, background and class; not the transform. Quantised values come as
/// floats.
/// grid    with a sound header (NvdbFile::load)
/// where   what messages start with
/// throws  vog::Error for a type that holds neither numbers nor vectors, for nodes that reach out
/// of
///         the buffer or overlap, for a checksum that does not match
openvdb::GridBase::Ptr grid_from_nano(const NanoBuffer& grid, const std::string& where);

/// The map of the grid's header, which may be singular.
Affine nano_transform(const NanoBuffer& grid);

}  // namespace vog
