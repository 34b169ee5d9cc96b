// file_table.h: header of a compact model: description, lattices, and the table of its blobs.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/vogz/columns.h"
#include "io/vogz/rounding.h"

namespace vog::vogz {

/// Contents of a blob.
enum class Kind : std::uint32_t {
    gaussians,  ///< shapes of Gaussians
    nodes,      ///< shapes of nodes of the hierarchy
    links,      ///< of those nodes
    field       ///< of the Gaussians or nodes before it
};

/// A run of bytes in the file, in the order of the table.
struct Blob {
    Kind kind = Kind::gaussians;
    std::uint32_t field = 0;  ///< place among the model's fields, scalar ones first
    /// Of nodes: their depth. Of Gaussians: that of their parents plus 1; 0 without a parent.
    std::uint32_t depth = 0;
    std::uint32_t count = 0;  ///< Gaussians or nodes
    std::uint32_t bytes = 0;
    std::uint32_t checksum = 0;  ///< CRC-32
    std::array<float, 6>
        box{};  ///< of the supports, relative to the origin: lower, then upper corner
};

/// Place of a run of Gaussians or nodes, with its fields, in the tree of a file's hierarchy.
struct TreeChunk {
    /// Place of the nodes that these are the children of, among the file's runs; none: there are none above.
    std::optional<std::uint32_t> parent{};
    double error = 0;  ///< largest Hierarchy::error of its nodes, world units; 0: of Gaussians
};

struct FileTable {
    Gaussians description;  ///< all but Gaussians
    bool rotated = false;
    Compression compression = Compression::zstd;
    VogzPrecision precision;
    ShapeRounding shapes;
    std::vector<FieldRounding> fields;  ///< scalar ones first
    std::vector<Blob> blobs;
    std::string page;               ///< VogzOptions::page; by writing alone
    std::vector<TreeChunk> tree;    ///< of each run of Gaussians or nodes in turn; empty: not known
    std::uint64_t body_offset = 0;  ///< of the first blob; by reading alone

    /// Sum over the blobs of a kind.
    std::size_t count(Kind kind) const;
};

/// Bytes before the first blob.
std::string header_bytes(const FileTable& table);
/// in      at the start of the file
/// size    of the file, bytes
/// throws  vog::Error for another format, a newer version, a wrong checksum or values out of range
FileTable read_table(ByteSource& in, std::uint64_t size);

std::uint32_t checksum(std::span<const char> bytes);

}  // namespace vog::vogz
