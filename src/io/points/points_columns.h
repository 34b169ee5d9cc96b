// points_columns.h: roles of the columns of a particle text file.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vog/points.h"

namespace vog::point_files {

/// Role of a column: -1 skipped, 0 to 2 position, 3 to 5 velocity, n >= 6 attribute n - 6.
inline constexpr int kSkipped = -1, kFirstVelocity = 3, kFirstAttribute = 6;

/// Layout of the lines of a file.
struct PointColumns {
    char separator = 0;     ///< 0: blanks
    std::vector<int> role;  ///< [columns]
    bool has_velocity = false;
    std::string length_unit{}, velocity_unit{};  ///< of positions and velocities; empty: not known
    std::array<double, kFirstAttribute> factor{1, 1, 1, 1, 1, 1};  ///< on numbers of each axis
    std::vector<std::string> attributes;                           ///< names
    std::vector<std::string> attribute_units;  ///< [attributes]; empty texts: not known
    std::uint64_t first_line = 0;              ///< number of the first particle's line, from 0
    std::optional<std::uint64_t> count;        ///< number of particles that the file states
    std::uint64_t count_line = 0;              ///< number of its line, from 0
    bool may_be_title = false;  ///< the first particle's line may be a title: `count` decides
    std::string note{};         ///< columns that their places name; empty: none
};

/// Extension in lower case, with its dot: ".csv", of a gzip'd "a.csv.gz" too.
std::string text_extension(const std::filesystem::path& file);

/// Separator that files of this extension are written with; 0 for blanks.
/// throws  vog::Error for an unknown extension
char own_separator(const std::filesystem::path& file);

/// Finds the roles of the columns from the first lines of a file.
/// title   a line that may_be_title is one
/// throws  vog::Error without a particle, without the requested columns, or with a header that does not fit the lines
PointColumns find_columns(const std::filesystem::path& file, std::string_view head,
                          const PointReadOptions& options, bool title = false);

}  // namespace vog::point_files
