// ply_nodes.h: the hierarchy of a model as the second element of its PLY (docs/formats.md).
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "vog/lod.h"

namespace vog::ply {

/// Header lines, "element node N" first; empty for a hierarchy without nodes.
std::string node_header(const Hierarchy& hierarchy);
/// "float x", "float y", ..., as a header has them after "property ".
std::vector<std::string> node_properties(bool axis_aligned);
std::size_t bytes_per_node(bool axis_aligned);

void write_nodes(std::ostream& out, const Hierarchy& hierarchy);
/// Reads `count` nodes; which children they have is left to link(). False where the stream ends
/// before.
bool read_nodes(std::istream& in, std::size_t count, bool axis_aligned, Hierarchy& hierarchy);

}  // namespace vog::ply
