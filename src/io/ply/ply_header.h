// ply_header.h: header of a PLY model: elements, property layout, comments (docs/formats.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "vog/gaussians.h"
#include "vog/lod.h"

namespace vog::ply {

/// Elements and comments of a PLY header; properties in file order.
struct Header {
    std::uint64_t vertices = 0, nodes = 0;  ///< rows of each element
    bool has_nodes = false;                 ///< an element `node` is declared, maybe with no rows
    std::vector<std::string> properties;    ///< names of a vertex's properties, all float32
    std::vector<std::string> node_properties;  ///< type and name: "float x"
    std::vector<std::string> comments;         ///< text after "comment "
    std::uint64_t body_offset = 0;             ///< bytes before the first row
};

/// Property layouts: vog's own, 3D Gaussian splatting's, and volprim's.
enum class Layout { vog, splatting, volprim };

/// throws vog::Error with `what` behind the name of the file
[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what);

/// Reads up to end_header; `in` is then at the first row.
/// throws vog::Error for another PLY format, unknown elements or lines, a truncated header
Header read_header(const std::filesystem::path& file, std::istream& in);

/// Layout by property names.
/// throws vog::Error for missing or ambiguous properties
Layout layout_of(const std::filesystem::path& file, const Header& header);
/// throws vog::Error for a property that is none of the layout and none of these fields
void refuse_unknown(const std::filesystem::path& file, const Header& header, Layout layout,
                    const Fields& fields);

/// Checks that the nodes have the properties that write_nodes gives them.
/// returns  bytes of a node's row; 0 without an element `node`
std::size_t check_nodes(const std::filesystem::path& file, const Header& header, Layout layout,
                        bool axis_aligned, const Fields& fields);

/// Sets cutoff, origin, box, source voxels, source, method, options and summary from vog's comments.
/// throws vog::Error if the cutoff is missing or a number is malformed
void read_comments(const std::filesystem::path& file, const Header& header, Gaussians& model);

/// Complete header of a file with `count` Gaussians and the nodes of `hierarchy`.
/// model  supplies the metadata only
std::string header_text(const Gaussians& model, std::uint64_t count, bool rotated,
                        const Hierarchy& hierarchy);

}  // namespace vog::ply
