// vog/text.h: counts and sizes as text for people.
#pragma once

#include <cstdint>
#include <string>

namespace vog {

/// Decimal digits in groups of three: 1234567 -> "1,234,567".
std::string count_text(std::uint64_t count);

/// Decimal units up to TB, one digit after the point: 999 -> "999 B", 4400000 -> "4.4 MB".
std::string bytes_text(std::uint64_t bytes);

}  // namespace vog
