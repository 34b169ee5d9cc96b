// vog/files.h: volumes from whatever file holds them, one grid or all levels of a mesh.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vog/levels.h"
#include "vog/vdb.h"
#include "vog/volume_part.h"

namespace vog {

/// read_nvdb for .nvdb, else read_vdb.
/// notes   what reading changed, in words, is added: "a.vdb: 3 negative values of 'density' set to
///         zero"
Volume read_volume(const std::filesystem::path& file, const VdbOptions& options = {},
                   std::vector<std::string>* notes = nullptr);

/// A volume in a file, whose parts are read as asked: of a .vdb without the rest; a .nvdb is held
/// whole.
class VolumeReader {
  public:
    /// throws vog::Error as VdbReader and read_nvdb do
    explicit VolumeReader(const std::filesystem::path& file, const VdbOptions& options = {});

    std::uint64_t active_voxels() const;  ///< of the whole, as stored
    Box world_box() const;                ///< of the whole
    const Affine& world_from_index() const;
    /// Negative values found are added to `negative`. throws vog::Error as VdbReader does
    Volume read(const VolumePart& part = {}, std::uint64_t* negative = nullptr);
    Volume read_where(const NodeChoice& wanted);

  private:
    std::optional<VdbReader> vdb_;
    Volume whole_;  ///< where there is no reader
    VdbNotes notes_;
};

/// Names of the grids of a .vdb or .nvdb, in file order.
std::vector<std::string> grid_names(const std::filesystem::path& file);

struct LevelOptions {
    std::string grid{};  ///< name, or a pattern with * and ?: all that match; empty: the default
    std::string mask{};  ///< name; its * is what the * of `grid` stands for; empty: no masks
    bool level_set_to_fog = false;
};

/// A volume that read_levels reads, and its mask.
struct LevelSource {
    std::filesystem::path file;
    std::string grid{};  ///< as VdbOptions::grid
    std::string mask{};  ///< empty: none
};
/// What read_levels reads, in its order. throws as it does for patterns and names
std::vector<LevelSource> level_sources(std::span<const std::filesystem::path> files,
                                       const LevelOptions& options = {});

/// Of each file one volume, or all whose names match.
/// throws vog::Error as read_volume does, and for a pattern no grid matches, listing the names; for
///        a pattern in one of grid and mask alone
Levels read_levels(std::span<const std::filesystem::path> files, const LevelOptions& options = {},
                   std::vector<std::string>* notes = nullptr);

}  // namespace vog
