// vog/files.h: volumes from whatever file holds them, one grid or all levels of a mesh.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "vog/levels.h"
#include "vog/vdb.h"

namespace vog {

/// read_nvdb for .nvdb, else read_vdb.
/// notes   what reading changed, in words, is added: "a.vdb: 3 negative values of 'density' set to
///         zero"
Volume read_volume(const std::filesystem::path& file, const VdbOptions& options = {},
                   std::vector<std::string>* notes = nullptr);

/// Names of the grids of a .vdb or .nvdb, in file order.
std::vector<std::string> grid_names(const std::filesystem::path& file);

struct LevelOptions {
    std::string
        grid{};  ///< name, or a pattern with * and ?: all that match; empty: the default one
    std::string mask{};  ///< name; its * is what the * of `grid` stands for; empty: no masks
    bool level_set_to_fog = false;
};

/// Of each file one volume, or all whose names match.
/// throws vog::Error as read_volume does, and for a pattern no grid matches, listing the names; for
/// a
///        pattern in one of grid and mask alone
Levels read_levels(std::span<const std::filesystem::path> files, const LevelOptions& options = {},
                   std::vector<std::string>* notes = nullptr);

}  // namespace vog
