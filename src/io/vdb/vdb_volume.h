// vdb_volume.h: conversion between OpenVDB grids and volumes.
#pragma once

#include <functional>
#include <string>

#include "io/vdb/vdb_grid.h"
#include "vog/volume_io.h"

namespace vog::vdb {

/// Volume of the active values: numbers unchanged, vectors by length. It has no name or source.
/// where   start of messages
/// throws  vog::Error for a transform that is singular or null (not affine), for negative and
///         non-finite values unless `rules` accept them, and for grids that hold no numbers
/// mask    values above 0 become 1, all others inactive
Volume density_from_grid(const openvdb::GridBase& grid,
                         const std::optional<Affine>& world_from_index, const std::string& where,
                         ValueNotes& notes, bool mask = false, const ValueRules& rules = {});

/// Sets counts, boxes and the range of values; of points, whose grid has the topology alone, no range. `info` has the
/// type and the map, and is increased by the memory.
void describe_grid(const openvdb::GridBase& grid, GridInfo& info);

/// Converts a level set to fog: 1 inside, a ramp from 0 to 1 over the inner narrow band.
/// throws vog::Error unless it is a float or double grid of class level set or unknown
void level_set_to_fog(openvdb::GridBase& grid, const std::string& where);

/// Sets a grid's transform without rounding.
/// where  start of messages
void set_transform(openvdb::GridBase& grid, const Affine& world_from_index,
                   const std::string& where);

/// Level of OpenVDB's tree that holds tiles of this edge.
openvdb::Index tile_level(std::int32_t edge);
/// Sets the metadata `unit`, `length_unit`, `up` and `front` that are known.
void set_metadata(openvdb::GridBase& grid, const Units& units, const Standing& standing);

/// A grid, and what writes the values of its leaves behind the topology; empty: the grid's own.
struct GridToWrite {
    openvdb::GridBase::Ptr grid;
    std::function<void(std::ostream&)> write_values;
};
/// Writes a file of `count` grids, with one in memory at a time; complete or not at all.
/// grid_of  makes grid n
void write_vdb_grids(const std::filesystem::path& file, std::size_t count,
                     const std::function<GridToWrite(std::size_t)>& grid_of);

}  // namespace vog::vdb
