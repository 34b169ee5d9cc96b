// ply_nodes.h: hierarchy of a model as the second PLY element, `node` (docs/formats.md).
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "vog/lod.h"

namespace vog::ply {

/// Names of the floats of a Gaussian, in the order of its row.
std::vector<std::string> gaussian_properties(bool rotated, const Fields& fields);
/// Header lines, "element node N" first; empty for an empty hierarchy.
std::string node_header(const Hierarchy& hierarchy);
/// Type and name of each property, as in header lines after "property ": "float x", ...
std::vector<std::string> node_properties(bool axis_aligned, const Fields& fields);
/// Bytes of a node's row.
std::size_t bytes_per_node(bool axis_aligned, const Fields& fields);

void write_nodes(std::ostream& out, const Hierarchy& hierarchy);
/// Reads `count` nodes without their child indices, which link() computes.
/// fields   of the model: names, units and ranges
/// returns  false if the stream ends early
bool read_nodes(std::istream& in, std::size_t count, bool axis_aligned, const Fields& fields,
                Hierarchy& hierarchy);

}  // namespace vog::ply
