// vog/text.h: counts, sizes and names from files as text for people.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace vog {

/// Decimal digits in groups of three: 1234567 -> "1,234,567".
std::string count_text(std::uint64_t count);

/// Decimal units up to TB, one digit after the point: 999 -> "999 B", 4400000 -> "4.4 MB".
std::string bytes_text(std::uint64_t bytes);

/// Text that a terminal shows and never obeys: valid UTF-8 on one line. Control characters
/// (also of the right-to-left kind, which reorder their surroundings) and bytes that are not UTF-8
/// become \\xNN, two hexadecimal digits a byte.
/// text  any bytes: names of files, names and values in files
/// most  longer texts end after this many bytes, between two characters, and in "..."
std::string printable(std::string_view text, std::size_t most = std::string_view::npos);

}  // namespace vog
