// field_grid.h: the grid of a field in memory, with its map and what its metadata state.
#pragma once

#include <openvdb/openvdb.h>

#include <string>

#include "vog/linear.h"
#include "vog/voxel_field.h"

namespace vog::field_files {

/// Map of stored vectors to vectors along the world's axes: linear * v + shift, then to unit length
/// if `normalize`.
struct VectorMap {
    Mat3 linear;
    Vec3d shift;
    bool normalize = false;

    bool identity() const { return linear == Mat3{} && shift == Vec3d{} && !normalize; }
    Vec3d operator()(Vec3d v) const;
};

/// Grid of a field.
struct FieldGrid {
    openvdb::GridBase::Ptr grid;  ///< values, states and background; its own transform is not set
    Affine world_from_index;
    VectorMap world_from_vector;
    bool staggered = false;  ///< component c of voxel i lies at index i - e_c / 2
    bool level_set = false;  ///< inactive voxels have a value: the sign
    std::string name, unit, length_unit{};
    std::string where;   ///< start of messages: "fire.vdb: grid 'temperature'"
    std::string note{};  ///< departures of its file from the format; empty: none
};

/// Reads the grid of a field, .nvdb by extension, else .vdb.
/// throws vog::Error as read_field does for files and grids
FieldGrid load_field_grid(const FieldSource& source);
/// Name of a field from the list of grids of its file.
/// throws vog::Error as load_field_grid does for files and grids
std::string name_of(const FieldSource& source);

}  // namespace vog::field_files
