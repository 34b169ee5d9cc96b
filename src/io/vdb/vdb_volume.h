// vdb_volume.h: OpenVDB grids to volumes, for the files named vdb_*.cpp only.
#pragma once

#include <functional>
#include <string>

#include "io/vdb/vdb_grid.h"
#include "vog/volume_io.h"

namespace vog::vdb {

/// Active values as density: numbers as they are, vectors by magnitude, negative ones as zero.
/// The volume gets neither name nor source.
/// where   what messages start with
/// throws  vog::Error for a transform that is singular or null (not affine), for non-finite values
///         and for grids that hold no numbers
/// mask    take values above 0 as 1, all else as inactive, and bool and mask grids too
Volume density_from_grid(const openvdb::GridBase& grid,
                         const std::optional<Affine>& world_from_index, const std::string& where,
                         VdbNotes& notes, bool mask = false);

/// Makes fog of a level set: 1 inside, a ramp from 0 to 1 over the inner half of the narrow band.
/// throws vog::Error unless it is a float or double grid of class level set or unknown
void level_set_to_fog(openvdb::GridBase& grid, const std::string& where);

/// Gives a grid a transform, exactly.
/// where  what messages start with
void set_transform(openvdb::GridBase& grid, const Affine& world_from_index,
                   const std::string& where);

/// Writes a file of `count` grids, one in memory at a time, whole or not at all.
void write_vdb_grids(const std::filesystem::path& file, std::size_t count,
                     const std::function<openvdb::GridBase::Ptr(std::size_t)>& grid_of);

}  // namespace vog::vdb
