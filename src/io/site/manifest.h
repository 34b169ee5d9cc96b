// manifest.h: description of a site's models and the trees of their chunks, as JSON.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "vog/gaussians.h"
#include "vog/site.h"

namespace vog::site {

/// A chunk in the tree.
struct Row {
    std::string name;             ///< content_name of its files
    std::uint32_t nodes = 0;      ///< nodes, the first Gaussians of the chunk
    std::uint32_t gaussians = 0;  ///< in all
    float error = 0;  ///< largest geometric error of the nodes, world units; 0 without nodes
    /// Box of the supports of the chunk and of all below, relative to the model's origin: lower, then upper corner.
    std::array<float, 6> box{};
    std::vector<std::uint32_t> bytes;  ///< of the shapes, then of each field, scalar ones first
    std::vector<Row> parts;            ///< replace the nodes
    std::string table;  ///< name of the file that has the parts in place of `parts`; empty: none
    std::uint32_t table_bytes = 0;  ///< size of that file

    std::uint64_t all_bytes() const;  ///< of shapes and fields
};

struct ManifestModel {
    std::string name;
    Gaussians description;  ///< all but Gaussians
    bool rotated = false;
    std::uint64_t gaussians = 0;    ///< leaves
    std::vector<SiteLevel> levels;  ///< by depth in the tree of chunks
    Row root;
};
struct Manifest {
    bool steps = false;
    std::vector<ManifestModel> models;
};

inline constexpr const char* kManifestName = "manifest.json";
inline constexpr const char* kChunksName = "chunks";

/// Number of a model's fields.
std::size_t field_count(const ManifestModel& model);
/// throws vog::Error for a model that the site lacks
const ManifestModel& model_at(const Manifest& manifest, std::size_t model,
                              const std::filesystem::path& folder);

/// Paths of a site's files.
std::filesystem::path shapes_path(const std::filesystem::path& folder, const std::string& name);
std::filesystem::path field_path(const std::filesystem::path& folder, const std::string& name,
                                 std::size_t field);
std::filesystem::path table_path(const std::filesystem::path& folder, const std::string& name);

std::string manifest_text(const Manifest& manifest);
/// Text of a table: the parts of a chunk.
std::string table_text(const std::vector<Row>& parts);

/// throws  vog::Error for a missing or malformed file, another format or version
Manifest read_manifest(const std::filesystem::path& folder);
/// Parts of a chunk from its table.
/// fields  number of the model's fields
/// throws  vog::Error for a missing, malformed or damaged file
std::vector<Row> read_parts(const std::filesystem::path& folder, const Row& row,
                            std::size_t fields);
/// Bytes of a file.
/// throws  vog::Error unless it can be read and has `size` bytes
std::string read_whole(const std::filesystem::path& file, std::uint64_t size);

}  // namespace vog::site
