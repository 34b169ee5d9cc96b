// vdb_reader.h: partial reading of one grid of a .vdb file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "data/volume_partition.h"
#include "io/grid_choice.h"
#include "vog/volume_io.h"

namespace vog::vdb {

/// Open grid of a file, whose values are read part by part. Holds about 100 bytes per leaf; a level
/// set that is converted to fog is held completely.
class VdbReader {
  public:
    /// throws vog::Error as read_vdb does, except for invalid values, which read() reports
    explicit VdbReader(const std::filesystem::path& file, const VdbOptions& options = {});
    ~VdbReader();
    VdbReader(VdbReader&&) noexcept;
    VdbReader& operator=(VdbReader&&) noexcept;

    std::uint64_t active_voxels() const;  ///< of the whole grid, as stored
    std::size_t leaf_count() const;       ///< of the whole grid; those with active voxels
    Box world_box() const;                ///< of the whole grid, as world_box(Volume)
    const Affine& world_from_index() const;
    /// Reads one part.
    /// throws vog::Error for values that are not finite, corrupt bytes, a whole mask without
    ///        a value above 0
    Volume read(const VolumePart& part = {}, ValueNotes* notes = nullptr);
    /// Reads the selected leaves and tiles.
    /// throws vog::Error as read does
    Volume read_where(const NodeChoice& selected, ValueNotes* notes = nullptr);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Choice where no grid is named.
/// levels  GridRequest::levels
/// throws  vog::Error as VdbReader does
DefaultGrid default_grid(const std::filesystem::path& file, const VdbOptions& options, bool levels);

}  // namespace vog::vdb
