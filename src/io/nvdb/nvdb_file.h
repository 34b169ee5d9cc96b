// nvdb_file.h: the frame of a .nvdb file: its segments, its list of grids, their bytes unpacked.
// Source: NanoVDB's io/IO.h of versions 32.0 to 32.9. That reader is not asked: it allocates what
// a corrupt length says, and forgets to throw where unpacking fails.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/aligned_buffer.h"
#include "io/byte_source.h"

namespace vog::nvdb {

/// Where one grid lies in its file.
struct NvdbEntry {
    std::string name;
    nanovdb::GridType type;
    std::uint16_t codec = 0;           ///< 0 none, 1 zip, 2 blosc
    std::uint64_t begin = 0, end = 0;  ///< bytes of the file
    std::uint64_t grid_bytes = 0;      ///< unpacked
};

class NvdbFile {
  public:
    /// throws vog::Error for a missing, foreign or truncated file and for another major version
    explicit NvdbFile(const std::filesystem::path& file);
    const std::string& name() const { return name_; }
    const std::vector<NvdbEntry>& entries() const { return entries_; }
    /// The grid, unpacked, whose header is sound: magic, version, size, checksum of its head.
    /// Nothing is said of its nodes.
    NanoBuffer load(const NvdbEntry& entry);
    /// What messages about a grid start with: "smoke.nvdb: grid 'density'".
    std::string where(const NvdbEntry& entry) const;

  private:
    void read_segment();
    std::string name_;
    FileBytes file_;
    std::vector<NvdbEntry> entries_;
};

/// "float", "Vec3f", ...; a number for a type that is not known.
std::string nano_type_name(nanovdb::GridType type);
/// CRC-32 as zip and NanoVDB compute it.
std::uint32_t crc32(const void* data, std::size_t bytes);

}  // namespace vog::nvdb
