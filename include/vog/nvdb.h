// vog/nvdb.h: NanoVDB files (.nvdb), read as volumes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "vog/vdb.h"
#include "vog/volume.h"

namespace vog {

/// Reads one grid of a NanoVDB file as density, by the rules of read_vdb: files of major version
/// 32, uncompressed, zip or blosc; floats, doubles, integers of 16, 32 and 64 bits, quantised
/// floats (Fp4, Fp8, Fp16, FpN), vectors by magnitude when asked by name. Tiles stay tiles. throws
/// vog::Error for a missing, foreign, truncated or corrupt file; another major version, naming it;
/// no, several or unknown grids (listing the names); a level set (unless options.level_set_to_fog);
/// a singular transform; an empty grid; non-finite values (their count and the first index)
Volume read_nvdb(const std::filesystem::path& file, const VdbOptions& options = {},
                 VdbNotes* notes = nullptr);

/// Names of the grids of a file, in file order.
/// throws vog::Error for a missing, foreign or truncated file
std::vector<std::string> nvdb_grid_names(const std::filesystem::path& file);

}  // namespace vog
