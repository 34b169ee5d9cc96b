// nvdb_grid.h: conversion of NanoVDB grids to OpenVDB grids, with every offset checked.
#pragma once

#include <openvdb/openvdb.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/aligned_buffer.h"
#include "io/grid_choice.h"
#include "io/vdb/vdb_density.h"
#include "vog/linear.h"
#include "vog/volume.h"

namespace vog::nvdb {

using namespace vdb;

/// Whether a grid of this type can be the default density grid.
bool is_scalar(nanovdb::GridType type);

/// Whether grid_from_nano reads grids of this type.
bool is_readable(nanovdb::GridType type);

/// Leaves with active voxels, as in a Volume, and the census of their values.
struct NanoLeaves {
    BigVector<Leaf> leaves;
    Census census;
};

/// OpenVDB grid with the values, active states, tiles, background and class, but no transform.
/// Quantised values become floats.
/// grid    with a checked header (NvdbFile::load)
/// where   start of messages
/// leaves  receives the leaves, and the grid has none; null: the grid has them
/// throws  vog::Error for a type that holds neither numbers nor vectors, for nodes beyond the
///         buffer or overlapping ones, for a checksum that does not match
openvdb::GridBase::Ptr grid_from_nano(const NanoBuffer& grid, const std::string& where,
                                      NanoLeaves* leaves = nullptr);

/// Choice where no grid is named, as vdb::default_grid.
DefaultGrid default_grid(const std::filesystem::path& file, const VdbOptions& options, bool levels);

/// Describes every grid of a .nvdb file, in file order; of types that are not read their name alone.
std::vector<GridInfo> inspect_nvdb(const std::filesystem::path& file);

/// World-from-index map of the grid's header; may be singular.
Affine nano_transform(const NanoBuffer& grid);

}  // namespace vog::nvdb
