// vog/volume_io.h: reading and writing of volumes: OpenVDB (.vdb) and NanoVDB (.nvdb) files.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "vog/levels.h"
#include "vog/volume.h"
#include "vog/voxel_values.h"

namespace vog {

/// Options of the readers of one grid.
struct VdbOptions {
    std::string
        grid{};  ///< name of the grid; empty: the only scalar grid, else "density", else the largest
    /// Convert a level set to fog: density 0 at the surface, rising to 1 over the inner half of the
    /// narrow band. Otherwise a level set is an error.
    bool level_set_to_fog = false;
    /// Read a mask, of bool and mask grids too: active values above 0 become 1, all else inactive.
    bool mask = false;
    ValueRules values{};  ///< values that are no density; negative ones are none of a mask
    /// Density 1 in every active voxel, of signed values, level sets, bool and mask grids too: a
    /// measure that counts volume. Values that are not finite are inactive, and reported.
    bool ones = false;
    /// Without a name a file of several grids, none called density, is an error: the result is a number.
    bool refuse_several = false;
};

/// Reads one grid of an OpenVDB file (.vdb, .vdb.gz) as density: float, double, half-stored and integer
/// grids, bool and mask grids as 0 and 1, and vector grids, by magnitude, if options.grid names them.
/// Tiles stay tiles.
/// notes   receives the changes made to values; null: not reported
/// throws  vog::Error for a missing, foreign or truncated file; no or unknown grids (their
///         names are listed); a level set (unless options.level_set_to_fog); a frustum or singular
///         transform; an empty grid; values negative or not finite (their count and the first
///         index), unless options.values accepts them
Volume read_vdb(const std::filesystem::path& file, const VdbOptions& options = {},
                ValueNotes* notes = nullptr);

/// Reads one grid of a NanoVDB file as density, by the rules of read_vdb. Files of major version
/// 32, uncompressed, zip or blosc; floats, doubles, integers of 16, 32 and 64 bits, quantised
/// floats (Fp4, Fp8, Fp16, FpN), bool and mask grids as 0 and 1, vectors by magnitude if options.grid
/// names them. Tiles stay tiles.
/// notes   receives the changes made to values; null: not reported
/// throws  vog::Error as read_vdb does, for a corrupt file, and for another major version
Volume read_nvdb(const std::filesystem::path& file, const VdbOptions& options = {},
                 ValueNotes* notes = nullptr);

/// Names of the grids of an OpenVDB file, in file order; "density[1]" where two have one name.
/// throws  vog::Error for a missing, foreign or truncated file
std::vector<std::string> vdb_grid_names(const std::filesystem::path& file);

/// Names of the grids of a NanoVDB file, in file order; "density[1]" where two have one name.
/// throws  vog::Error for a missing, foreign or truncated file
std::vector<std::string> nvdb_grid_names(const std::filesystem::path& file);

/// Reads one grid as density, by extension: read_nvdb for .nvdb, dense images (vog/scan_io.h), else read_vdb.
/// notes   receives a line on the choice among several grids, and one on changes made to values, behind those already there;
///         null: not reported
/// throws  vog::Error as these readers do
Volume read_volume(const std::filesystem::path& file, const VdbOptions& options = {},
                   std::vector<std::string>* notes = nullptr);

/// Names of the grids of a .vdb or .nvdb, in file order.
/// throws  vog::Error for a missing, foreign or truncated file
std::vector<std::string> grid_names(const std::filesystem::path& file);

/// Pattern of names that differ only in a number at their end, with * in its place: "density_L*" of density_L0 and
/// density_L1. Beside levels of other names those called density. Empty: the names are not levels.
std::string level_pattern(const std::vector<std::string>& names);

/// Options of read_levels.
struct LevelOptions {
    /// Name of the grid in each file, or a pattern (* any text, ? any letter) for all grids that
    /// match. Empty: all grids of a level_pattern, else as VdbOptions::grid, of the same name in all files that have it.
    std::string grid{};
    /// Name of the grid with the mask of each volume (Levels::masks). A * in it stands for the text
    /// that the * of `grid` matched. Empty: no masks.
    std::string mask{};
    bool level_set_to_fog = false;  ///< as VdbOptions::level_set_to_fog, for volumes, not for masks
    ValueRules values{};            ///< as VdbOptions::values
    bool ones = false;              ///< as VdbOptions::ones, for volumes, not for masks
    bool refuse_several = false;    ///< as VdbOptions::refuse_several
};

/// Reads the levels of an adaptive mesh (vog/levels.h): one volume of each file, or one for each
/// grid that matches a pattern, in the order of files and grids.
/// notes   as in read_volume
/// throws  vog::Error as read_volume does, for a pattern that no grid matches (the names are
///         listed), and for a pattern in `grid` or `mask` unless both have a *
Levels read_levels(std::span<const std::filesystem::path> files, const LevelOptions& options = {},
                   std::vector<std::string>* notes = nullptr);

/// Writes a volume as an OpenVDB FloatGrid of class fog volume, compressed by blosc where OpenVDB
/// has it. Written beside the file and renamed when whole.
/// half    store values as half floats, up to 65504
/// throws  vog::Error for an invalid or empty volume, a value too large for a half float, or if the
///         file cannot be written
void write_vdb(const std::filesystem::path& file, const Volume& volume, bool half = false);
/// Writes several volumes as grids of one OpenVDB file.
/// volumes  at least one; of several each needs a name of its own
/// throws   vog::Error as the one above, for no volume, an empty name or two equal ones
void write_vdb(const std::filesystem::path& file, std::span<const Volume> volumes,
               bool half = false);

/// Description of one grid of a file, as `vog info` prints it.
struct GridInfo {
    std::string name,                 ///< "density"
        type,                         ///< type of the values: "float", "vec3s", "points"
        grid_class;                   ///< OpenVDB's class: "fog volume", "level set", "unknown"
    bool half_stored = false;         ///< values are half floats in the file
    std::uint64_t active_voxels = 0;  ///< active voxels; a tile counts edge^3
    std::array<std::uint64_t, 3> active_tiles{};  ///< active tiles of 8^3, 128^3, 4096^3 voxels
    std::uint64_t leaves = 0,                     ///< leaves of 8^3 voxels
        dense_leaves = 0;                         ///< leaves with all 512 voxels active
    std::uint64_t points = 0;                     ///< particles of a PointDataGrid; else 0
    Vec3i lower, upper;       ///< least and largest active index; both 0 where none is active
    Box world;                ///< box around the active voxels, world units; empty where none is
    Affine world_from_index;  ///< from indices to world units
    bool affine = true;       ///< false: a frustum, for which world_from_index and world are unset
    double min = 0, max = 0;  ///< over active values; vectors by magnitude, 0 for points
    std::uint64_t memory_bytes = 0;  ///< size of the tree in memory, bytes
};

/// Describes every grid of an OpenVDB file, in file order.
/// throws  vog::Error for a missing, foreign, truncated or corrupt file
std::vector<GridInfo> inspect_vdb(const std::filesystem::path& file);

}  // namespace vog
