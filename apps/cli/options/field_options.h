// field_options.h: texts that name the fields of a conversion.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "vog/voxel_field.h"

namespace vog::cli {

/// Parses one field: GRID (of the input), FILE:GRID, FILE (its default grid; must exist), each also
/// behind NAME=. Parts of a text that are existing files win: a file or grid name may hold colons
/// and equals signs.
/// input    file of the measure, for texts without a file
/// returns  name empty where the text states none and no grid
/// throws   CLI::ValidationError for an empty name or grid, and a name that is no field's: letters,
///          digits, _ and -, no column of a model's PLY file
FieldSource parse_field(const std::string& text, const std::filesystem::path& input);
/// Parses all fields of a command.
/// throws  CLI::ValidationError as parse_field does, and for a name used twice
std::vector<FieldSource> parse_fields(std::span<const std::string> texts,
                                      const std::filesystem::path& input);

}  // namespace vog::cli
