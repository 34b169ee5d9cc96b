// vog/volume_io.h: volumes from OpenVDB and NanoVDB files, one grid or all levels of a mesh, and back.
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

namespace vog {

struct VdbOptions {
    std::string grid{};             ///< name; empty: the only scalar grid, else "density"
    bool level_set_to_fog = false;  ///< take a level set's inside as fog; refused otherwise
    /// Take active values above 0 as 1 and all else as inactive, of bool and mask grids too.
    bool mask = false;
};

/// What reading changed; the command line says it.
struct VdbNotes {
    std::uint64_t clamped_negative = 0;  ///< active values below zero, set to zero; a tile is one
};

/// Reads one grid as density. Float, double, half-stored and integer grids; vector grids by
/// magnitude when asked by name. Tiles stay tiles.
/// throws vog::Error for a missing, foreign or truncated file; no, several or unknown grids
/// (listing the names); a level set, a frustum or singular transform; an empty grid; non-finite
/// values (their count and the first index)
Volume read_vdb(const std::filesystem::path& file, const VdbOptions& options = {},
                VdbNotes* notes = nullptr);

/// Reads one grid of a NanoVDB file as density, by the rules of read_vdb: files of major version
/// 32, uncompressed, zip or blosc; floats, doubles, integers of 16, 32 and 64 bits, quantised
/// floats (Fp4, Fp8, Fp16, FpN), vectors by magnitude when asked by name. Tiles stay tiles. throws
/// vog::Error for a missing, foreign, truncated or corrupt file; another major version, naming it;
/// no, several or unknown grids (listing the names); a level set (unless options.level_set_to_fog);
/// a singular transform; an empty grid; non-finite values (their count and the first index)
Volume read_nvdb(const std::filesystem::path& file, const VdbOptions& options = {},
                 VdbNotes* notes = nullptr);

/// Names of the grids of a file, in file order; "density[1]" where two have one name.
/// throws vog::Error for a missing, foreign or truncated file
std::vector<std::string> vdb_grid_names(const std::filesystem::path& file);

/// Names of the grids of a file, in file order.
/// throws vog::Error for a missing, foreign or truncated file
std::vector<std::string> nvdb_grid_names(const std::filesystem::path& file);

/// read_nvdb for .nvdb, else read_vdb.
/// notes   what reading changed, in words, is added: "a.vdb: 3 negative values of 'density' set to
///         zero"
Volume read_volume(const std::filesystem::path& file, const VdbOptions& options = {},
                   std::vector<std::string>* notes = nullptr);

/// Names of the grids of a .vdb or .nvdb, in file order.
std::vector<std::string> grid_names(const std::filesystem::path& file);

struct LevelOptions {
    std::string grid{};  ///< name, or a pattern with * and ?: all that match; empty: the default
    std::string mask{};  ///< name; its * is what the * of `grid` stands for; empty: no masks
    bool level_set_to_fog = false;
};

/// Of each file one volume, or all whose names match.
/// throws vog::Error as read_volume does, and for a pattern no grid matches, listing the names; for
///        a pattern in one of grid and mask alone
Levels read_levels(std::span<const std::filesystem::path> files, const LevelOptions& options = {},
                   std::vector<std::string>* notes = nullptr);

/// Writes `volume` as a FloatGrid of class fog volume: blosc-compressed where the library has it,
/// values as half floats if `half`. Written beside the file and renamed.
void write_vdb(const std::filesystem::path& file, const Volume& volume, bool half = false);
/// Several grids in one file. throws vog::Error where two have the same name, or one has none
void write_vdb(const std::filesystem::path& file, std::span<const Volume> volumes,
               bool half = false);

/// One grid of a file, as `vog info` tells it.
struct GridInfo {
    std::string name, type, grid_class;  ///< "density", "float", "fog volume"
    bool half_stored = false;
    std::uint64_t active_voxels = 0;              ///< tiles included
    std::array<std::uint64_t, 3> active_tiles{};  ///< of 8^3, 128^3 and 4096^3 voxels
    std::uint64_t leaves = 0, dense_leaves = 0;
    std::uint64_t points = 0;  ///< of a PointDataGrid
    Vec3i lower, upper;        ///< active bounding box, inclusive indices
    Box world;                 ///< of the active bounding box, voxel faces included
    Affine world_from_index;
    bool affine = true;              ///< false: a frustum, world_from_index is unset
    double min = 0, max = 0;         ///< over active values; magnitudes for vectors, 0 for points
    std::uint64_t memory_bytes = 0;  ///< of the tree in memory
};

/// Every grid of the file, in file order. throws vog::Error as read_vdb does
std::vector<GridInfo> inspect_vdb(const std::filesystem::path& file);

}  // namespace vog
