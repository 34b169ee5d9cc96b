// vdb_transform.h: reading and writing of index-to-world transforms in .vdb files.
// Not through OpenVDB's map classes: they refuse voxels of a volume below 3e-15, and round a scale
// by its translation when they simplify a matrix.
#pragma once

#include <optional>
#include <string>

#include "io/byte_source.h"
#include "vog/linear.h"

namespace vog::vdb {

/// Reads a transform; none for one that is not affine (a frustum).
/// throws vog::Error for a type that OpenVDB does not have
std::optional<Affine> read_transform(ByteSource& in);

/// Bytes of a transform, as the simplest of OpenVDB's types that holds it exactly.
std::string transform_bytes(const Affine& world_from_index);

}  // namespace vog::vdb
