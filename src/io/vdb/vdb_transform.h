// vdb_transform.h: index-to-world transforms as a .vdb file stores them.
// Read and written here rather than through OpenVDB's map classes, which refuse voxels whose volume
// is below 3e-15 and round a scale by its translation when they simplify a matrix.
#pragma once

#include <optional>
#include <string>

#include "io/byte_source.h"
#include "vog/linear.h"

namespace vog::vdb {

/// The transform at the front of `in`; nothing for one that is not affine (a frustum).
/// throws vog::Error for a kind that OpenVDB does not have
std::optional<Affine> read_transform(ByteSource& in);

/// The bytes of `world_from_index`, as the simplest kind that holds it exactly.
std::string transform_bytes(const Affine& world_from_index);

}  // namespace vog::vdb
