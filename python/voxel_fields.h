// voxel_fields.h: fields of voxels as Python callers give them.
#pragma once

#include <string>
#include <vector>

#include "bindings.h"
#include "vog/volume.h"
#include "vog/voxel_field.h"

namespace vog::python {

/// Lattice of a level, of which a volume is a part.
struct Lattice {
    Affine world_from_index;
    std::size_t level = 0;
};
/// The lattices of volumes that are levels themselves, in their order.
std::vector<Lattice> lattices_of(const std::vector<Volume>& volumes);

/// Samples fields at the voxels of volumes. Of each field the caller gives an array [X, Y, Z] or [X, Y, Z, 3]
/// whose first element is voxel (0, 0, 0) of the volume's lattice, a pair ((i, j, k), array) for another first
/// voxel, a list of such pairs, a Volume, or the name of a grid in the volume's file; of several levels a list
/// with one of these for each. A dict {"value": ..., "unit": "K"} around it states the unit.
/// fields   a mapping by name; None: none
/// volumes  their tiles inside which a field varies are divided
/// lattices [volumes] of the levels they are of
/// count    number of levels
/// call     name of the Python function, for errors
/// returns  [fields][volumes]; warns of fields that cover a part of the volumes
std::vector<std::vector<VoxelField>> voxel_fields_of(const py::object& fields,
                                                     std::vector<Volume>& volumes,
                                                     const std::vector<Lattice>& lattices,
                                                     std::size_t count, const std::string& call);

}  // namespace vog::python
