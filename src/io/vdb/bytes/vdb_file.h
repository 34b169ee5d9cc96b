// vdb_file.h: container of a .vdb file: header, list of grids, positions of their bytes.
// Source: OpenVDB's io/Archive.cc and io/GridDescriptor.cc, file versions 222 (2013) to 225.
// OpenVDB 10.0.1 itself is not used: it allocates whatever a corrupt length declares, and ignores
// short reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/byte_source.h"
#include "vog/linear.h"
#include "vog/subject.h"

namespace vog::vdb {

/// Entry of one grid in a file.
struct VdbEntry {
    std::string name;  ///< for display: "density", or "density[1]" if several grids share a name
    std::string plain_name;   ///< without that number
    std::string unique_name;  ///< as stored
    std::string tree_type;    ///< "Tree_float_5_4_3"
    bool half_stored = false;
    std::string parent;  ///< unique name of the grid whose tree it shares; empty: none
    std::uint64_t begin = 0, end = 0;  ///< range of bytes in the file
};

/// Metadata of a grid, as far as readers use it; empty where a grid has none.
struct VdbMetadata {
    std::string grid_class;   ///< "fog volume", "level set", ...
    std::string vector_type;  ///< of vectors: "invariant", "contravariant relative", ...
    std::string unit;         ///< text "unit" or "units"
    std::string length_unit;  ///< of world lengths, as write_vdb states it
    Standing standing;  ///< as write_vdb states it; z up of Blender, Mantaflow, levels of a mesh
    bool local_space = false;  ///< vectors are in index space, not along the world's axes
};

/// Data before a grid's tree.
struct VdbHead {
    std::uint32_t compression = 0;  ///< openvdb::io::COMPRESS_* flags
    std::string grid_class;         ///< "fog volume", "level set", "unknown", ...
    VdbMetadata metadata;
    std::optional<Affine> world_from_index;  ///< none: not affine
};

/// Open .vdb file.
class VdbFile {
  public:
    /// throws vog::Error for a missing, foreign, too old or truncated file
    explicit VdbFile(const std::filesystem::path& file);
    const std::string& name() const { return name_; }
    std::uint32_t version() const { return version_; }
    const std::vector<VdbEntry>& entries() const { return entries_; }
    const Standing& standing() const { return standing_; }  ///< VdbMetadata::standing of the file
    /// Bytes of a grid: head, tree topology, voxel values.
    BigVector<char> bytes(const VdbEntry& entry) { return bytes(entry.begin, entry.end); }
    BigVector<char> bytes(std::uint64_t begin, std::uint64_t end) {
        return file_.range(begin, end);
    }
    /// The same bytes, read on demand. One range at a time, and no call of bytes() meanwhile.
    FileRange range(const VdbEntry& entry) {
        return FileRange(file_, entry.begin, entry.end, where(entry));
    }
    /// Start of messages about a grid: "smoke.vdb: grid 'density'".
    std::string where(const VdbEntry& entry) const;

  private:
    void read_header();
    void read_entry();
    std::string name_;
    FileBytes file_;
    std::uint32_t version_ = 0;
    std::vector<VdbEntry> entries_;
    Standing standing_;
};

/// Reads the head of a grid up to its tree, or to its end if it shares another grid's tree.
VdbHead read_vdb_head(ByteSource& in);

/// Reads a list of named metadata to its end.
VdbMetadata read_vdb_metadata(ByteSource& in);

}  // namespace vog::vdb
