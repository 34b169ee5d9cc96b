// nvdb_file.h: container of a .nvdb file: segments, list of grids, decompressed bytes of a grid.
// Source: NanoVDB's io/IO.h, versions 32.0 to 32.9. That reader is not used: it allocates whatever
// a corrupt length declares, and ignores failed decompression.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/aligned_buffer.h"
#include "io/byte_source.h"
#include "io/grid_choice.h"

namespace vog::nvdb {

/// Whether a file is a .nvdb or .nvdb.gz, by its extension in any case.
bool is_nvdb(const std::filesystem::path& file);

/// Entry of one grid in a file.
struct NvdbEntry {
    std::string name;  ///< for display: "density", or "density[1]" if several grids share a name
    std::string plain_name;  ///< without that number
    nanovdb::GridType type;
    std::uint16_t codec = 0;           ///< 0 none, 1 zip, 2 blosc
    std::uint64_t begin = 0, end = 0;  ///< range of bytes in the file
    std::uint64_t grid_bytes = 0;      ///< decompressed size
    std::uint64_t voxels = 0;          ///< active ones, as the file's list of grids states
    bool level_set = false;
};

/// Open .nvdb file.
class NvdbFile {
  public:
    /// throws vog::Error for a missing, foreign or truncated file and for another major version
    explicit NvdbFile(const std::filesystem::path& file);
    const std::string& name() const { return name_; }
    const std::vector<NvdbEntry>& entries() const { return entries_; }
    /// Decompresses a grid and checks magic number, version and size of its header, not its nodes.
    /// throws vog::Error for a corrupt stream or header
    NanoBuffer load(const NvdbEntry& entry);
    /// Start of messages about a grid: "smoke.nvdb: grid 'density'".
    std::string where(const NvdbEntry& entry) const;

  private:
    void read_segment();
    std::string name_;
    FileBytes file_;
    std::vector<NvdbEntry> entries_;
};

/// Grid of this name, or by the rule of vdb::chosen_entry.
/// throws vog::Error as chosen_of does
const NvdbEntry& chosen_entry(const NvdbFile& file, const GridRequest& request,
                              DefaultGrid* answer = nullptr, bool level_sets = false);

/// "float", "Vec3f", ...; "type 42" for an unknown one.
std::string nano_type_name(nanovdb::GridType type);
/// CRC-32 of zip (polynomial 0xEDB88320), as NanoVDB uses it.
std::uint32_t crc32(const void* data, std::size_t bytes);

}  // namespace vog::nvdb
