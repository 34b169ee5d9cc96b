// column_names.h: names of columns by which they are known, and the names and units that heads of formats state.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vog::point_files {

using Fields = std::vector<std::string_view>;
using Names = std::vector<std::string>;

/// Columns named prefix + x, y, z or prefix + 0, 1, 2, in any case and with a unit in brackets, for the first prefix that has
/// all three; empty: none.
/// throws  vog::Error for two columns of one such name
std::vector<std::size_t> position_columns(const Names& names);
std::vector<std::size_t> velocity_columns(const Names& names);

/// Whether fields name x, y and z.
bool names_position(const Fields& fields);

/// A comment without the characters that begin it.
std::string_view without_mark(std::string_view comment);
/// Fields of a header. It may have another separator than the particles, `own`, and a word before: "columns: x, y, z".
Fields header_fields(std::string_view line, char own);

/// Name of a column that has none, from 0.
std::string number_name(std::size_t column);
bool is_number(std::string_view field);
bool is_whole(std::string_view field);

/// Columns of extended XYZ: "Properties=species:S:1:pos:R:3" has species, pos_x, pos_y, pos_z.
/// returns  empty without the word, or where it is malformed
Names extended_names(std::string_view title);
/// Columns of a line that counts them from 0, as pandas writes columns without names, with an empty field above its index: "0,1,2"
/// or ",0,1,2". The position is in the first three that are counted.
/// returns  empty for other lines
Names counted_names(const Fields& fields);
/// Units of the columns, from the comments of ECSV by astropy: "- {name: x, unit: kpc, datatype: float64}", over several lines where
/// a column has more.
/// returns  [names], empty texts: none
Names ecsv_units(const Fields& comments, const Names& names);

}  // namespace vog::point_files
