// points_head.h: separator, headers and first particles of a text file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vog::point_files {

/// First lines of a file, up to some of its particles.
struct PointHead {
    char separator = 0;              ///< 0: blanks
    std::vector<std::string> names;  ///< of the columns; empty: unknown
    std::vector<std::string>
        units;  ///< of named columns, by a line below the names or by ECSV; empty texts: none
    std::string
        misfit;  ///< reason why a header with x, y and z does not name the columns; empty: none
    std::vector<std::vector<std::string>> rows;  ///< fields of the first particles, one a column
    std::uint64_t line = 0;                      ///< number of the first particle's line, from 0
    std::optional<std::uint64_t> count;          ///< number of particles that a line states
    std::uint64_t count_line = 0;                ///< number of that line, from 0
    bool titled = false;   ///< chemistry's XYZ: count, title, then lines that start with an element
    bool counted = false;  ///< a line numbers the columns from 0 in place of names
    bool may_be_title = false;  ///< the first particle's line may be the title instead

    std::size_t columns() const { return rows.front().size(); }
};

/// own    separator to prefer where the lines leave a choice
/// xyz    a count is followed by a title
/// title  a line that may_be_title is one
/// throws vog::Error, without the name of the file, where there is no particle
PointHead read_head(std::string_view text, char own, bool xyz, bool title);

}  // namespace vog::point_files
