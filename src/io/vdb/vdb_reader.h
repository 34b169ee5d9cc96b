// vdb_reader.h: one grid of a .vdb file, its values read part by part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "data/volume_partition.h"
#include "vog/volume_io.h"

namespace vog::vdb {

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

}  // namespace vog::vdb
