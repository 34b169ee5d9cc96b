// ply_rows.h: rows of a PLY element as floats: binary of either byte order or ASCII, of any type of numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <vector>

#include "io/ply/ply_header.h"

namespace vog::ply {

/// Bytes of a row; 0 for ASCII and for elements with lists, whose rows differ.
std::size_t row_bytes(const Header& header, const Element& element);

/// Moves `in` from the first row of the file to the first vertex.
/// throws vog::Error if the stream ends before
void skip_to_vertices(const std::filesystem::path& file, std::istream& in, const Header& header);

/// Moves `in` over vertices.
void skip_vertices(const std::filesystem::path& file, std::istream& in, const Header& header,
                   std::uint64_t count);

/// Reads the next `count` vertices, rounded to floats.
/// shift  [properties] subtracted from doubles and from text before
/// rows   receives [count][properties]
/// throws vog::Error if the stream ends before, and for words that are no numbers
void read_vertices(const std::filesystem::path& file, std::istream& in, const Header& header,
                   std::size_t count, const std::vector<double>& shift, std::vector<float>& rows);

}  // namespace vog::ply
