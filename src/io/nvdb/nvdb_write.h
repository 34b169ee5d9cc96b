// nvdb_write.h: writing of OpenVDB grids as .nvdb files.
#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <filesystem>
#include <functional>

namespace vog::nvdb {

/// Writes a file of `count` grids of floats or float vectors, compressed by blosc, with one grid in memory at a time;
/// complete or not at all.
/// grid_of  makes grid n
/// throws   vog::Error if the file cannot be written, or the memory for a grid is lacking
void write_nvdb_grids(const std::filesystem::path& file, std::size_t count,
                      const std::function<openvdb::GridBase::Ptr(std::size_t)>& grid_of);

}  // namespace vog::nvdb
