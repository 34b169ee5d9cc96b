// field_options.h: texts that name the fields of a conversion.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vog/convert_points.h"
#include "vog/voxel_field.h"

namespace vog::cli {

/// Parses one field: GRID (of the input), FILE:GRID, FILE (its default grid; must exist), each also
/// behind NAME=. Parts of a text that are existing files win: a file or grid name may hold colons
/// and equals signs. Grids that are patterns need a name.
/// returns  file empty where the text states none (field_of_level), name empty where it states
///          neither name nor grid
/// throws   UsageError for an empty name or grid, and a name that is no field's: letters,
///          digits, _ and -, no column of a model's PLY file
FieldSource parse_field(const std::string& text);
/// Parses all fields of a command.
/// throws  UsageError as parse_field does, and for a name used twice
std::vector<FieldSource> parse_fields(std::span<const std::string> texts);

/// Parses the fields of particles: COLUMN, or NAME=COLUMN.
/// throws  UsageError as parse_fields does
std::vector<PointField> parse_point_fields(std::span<const std::string> texts);

}  // namespace vog::cli
