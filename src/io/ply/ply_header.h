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

/// Order of the bytes of a file, or ASCII.
enum class Format { little_endian, big_endian, ascii };
/// Types of numbers: char or int8, uchar or uint8, ...
enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
/// Bytes of a number.
std::size_t bytes_of(Type type);

struct Property {
    std::string name;
    Type type = Type::float32;
    bool is_list = false;
    Type count = Type::uint8;  ///< of a list's length
};
struct Element {
    std::string name;
    std::uint64_t count = 0;  ///< rows
    std::vector<Property> properties;
};

/// Elements and comments of a PLY header; elements and properties in file order.
struct Header {
    Format format = Format::little_endian;
    char line_end = '\n';  ///< or CR; LF may follow CR
    std::vector<Element> elements;
    std::size_t vertex = 0;               ///< index of the element `vertex`
    std::uint64_t vertices = 0;           ///< rows of `vertex`
    std::vector<std::string> properties;  ///< names of a vertex's properties
    std::vector<std::string> comments;    ///< text after "comment "
    std::uint64_t body_offset = 0;        ///< bytes before the first row

    /// Element `node` behind the vertices, maybe with no rows; null: none.
    const Element* nodes() const {
        const bool has = vertex + 1 < elements.size() && elements[vertex + 1].name == "node";
        return has ? &elements[vertex + 1] : nullptr;
    }
};

/// Property layouts: vog's own, 3D Gaussian splatting's, and volprim's.
enum class Layout { vog, splatting, volprim };

/// throws vog::Error with `what` behind the name of the file
[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what);

/// Reads up to end_header; `in` is then at the first row.
/// throws vog::Error for unknown lines and types, lists among a vertex's properties, a truncated header
Header read_header(const std::filesystem::path& file, std::istream& in);

/// Layout by property names.
/// throws vog::Error for missing or ambiguous properties
Layout layout_of(const std::filesystem::path& file, const Header& header);
/// Checks that a file in vog's own layout has no more than that layout, these fields and nodes, as binary float32.
/// throws vog::Error naming the first that it does not know; other layouts are read by the names of their properties alone
void refuse_unknown(const std::filesystem::path& file, const Header& header, Layout layout,
                    const Fields& fields);

/// Checks that the nodes have the properties that write_nodes gives them.
/// returns  bytes of a node's row; 0 without an element `node`
std::size_t check_nodes(const std::filesystem::path& file, const Header& header, bool axis_aligned,
                        const Fields& fields);

/// Sets cutoff, origin, box, source voxels, source, method, options and summary from vog's comments.
/// throws vog::Error if the cutoff is missing or a number is malformed
void read_comments(const std::filesystem::path& file, const Header& header, Gaussians& model);

/// Takes splats of 3DGS to the frame of their data, where a comment of vog's states it.
/// throws vog::Error if the comment is malformed
void read_frame(const std::filesystem::path& file, const Header& header, Gaussians& model);

/// Complete header of a file with `count` Gaussians and the nodes of `hierarchy`.
/// model  supplies the metadata only
std::string header_text(const Gaussians& model, std::uint64_t count, bool rotated,
                        const Hierarchy& hierarchy);

}  // namespace vog::ply
