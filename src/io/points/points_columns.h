// points_columns.h: which column of a text file is what.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "vog/points.h"

namespace vog::point_files {

/// What a column is: left out, a component of position or velocity, or attribute role - 6.
inline constexpr int kLeftOut = -1, kFirstVelocity = 3, kFirstAttribute = 6;

struct PointColumns {
    char separator = 0;     ///< 0: blanks
    std::vector<int> role;  ///< [columns]
    bool has_velocity = false;
    std::vector<std::string> attributes;  ///< names
    std::uint64_t first_line = 0;         ///< of the particles, from 0
};

/// The separator by extension: 0 for blanks; throws vog::Error for an extension that is no text's.
/// `head`  the file's first lines: tells whether a .csv has semicolons
char text_separator(const std::filesystem::path& file, std::string_view head);

/// Reads the head of a file. throws vog::Error if it holds no particles or not the columns asked
/// for
PointColumns find_columns(const std::filesystem::path& file, std::string_view head,
                          const PointReadOptions& options);

}  // namespace vog::point_files
