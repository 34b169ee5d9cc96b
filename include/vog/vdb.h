// vog/vdb.h: OpenVDB files, read and written, and what is inside them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "vog/volume.h"
#include "vog/volume_part.h"

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

/// A grid of a file whose values are still there: what it holds is known, and parts of it are read
/// as asked. Holds about 100 bytes for each leaf (a level set that is to be fog: all of it).
class VdbReader {
  public:
    /// throws vog::Error as read_vdb does, but for what values alone can show
    explicit VdbReader(const std::filesystem::path& file, const VdbOptions& options = {});
    ~VdbReader();
    VdbReader(VdbReader&&) noexcept;
    VdbReader& operator=(VdbReader&&) noexcept;

    std::uint64_t active_voxels() const;  ///< of the whole, as stored
    std::size_t leaf_count() const;       ///< of the whole: those with active voxels
    Box world_box() const;                ///< of the whole, as world_box(Volume) has it
    const Affine& world_from_index() const;
    /// throws vog::Error for values that are not finite, for bytes that are not sound, for a mask
    ///        without a value above 0 (of the whole)
    Volume read(const VolumePart& part = {}, VdbNotes* notes = nullptr);
    /// Those leaves and tiles alone. throws as read does
    Volume read_where(const NodeChoice& wanted, VdbNotes* notes = nullptr);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Names of the grids of a file, in file order; "density[1]" where two have one name.
/// throws vog::Error for a missing, foreign or truncated file
std::vector<std::string> vdb_grid_names(const std::filesystem::path& file);

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
