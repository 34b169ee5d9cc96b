// text.cpp: counts with separators, bytes with units, texts without control characters.
#include "vog/text.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "vog/error.h"

namespace vog {

namespace {

/// First character of a text.
struct Character {
    std::size_t bytes = 1;   ///< in UTF-8
    char32_t code = 0xfffd;  ///< code point
    bool valid = false;      ///< false: its first byte is no UTF-8
};

/// Decodes by the table of well-formed sequences: shortest form, no surrogates, up to U+10FFFF.
Character first_character(std::string_view text) {
    const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(text[n]); };
    const unsigned char lead = byte(0);
    if (lead < 0x80) return {1, lead, true};
    const std::size_t bytes = lead < 0xc0 ? 0 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
    if (bytes == 0 || lead > 0xf4 || text.size() < bytes) return {};
    char32_t code = lead & (0x7fu >> bytes);
    for (std::size_t n = 1; n < bytes; ++n) {
        if ((byte(n) & 0xc0) != 0x80) return {};
        code = code << 6 | (byte(n) & 0x3fu);
    }
    constexpr char32_t kLeast[] = {0x80, 0x800, 0x10000};
    if (code < kLeast[bytes - 2] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return {};
    return {bytes, code, true};
}

/// Controls of C0 and C1, separators of lines and paragraphs, and marks of writing direction.
bool is_control(char32_t code) {
    return code < 0x20 || (code >= 0x7f && code < 0xa0) || (code >= 0x2028 && code <= 0x202e) ||
           (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

std::string count_text(std::uint64_t count) {
    std::string text = std::to_string(count);
    for (int at = static_cast<int>(text.size()) - 3; at > 0; at -= 3)
        text.insert(static_cast<std::size_t>(at), 1, ',');
    return text;
}

std::string bytes_text(std::uint64_t bytes) {
    constexpr const char* kUnits[] = {"B", "kB", "MB", "GB", "TB"};
    double value = static_cast<double>(bytes);
    std::size_t unit = 0;
    while (value >= 1000 && unit + 1 < std::size(kUnits)) value /= 1000, ++unit;
    return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.1f} {}", value, kUnits[unit]);
}

std::string printable(std::string_view text, std::size_t most) {
    std::string shown;
    for (std::size_t at = 0; at < text.size();) {
        const Character character = first_character(text.substr(at));
        if (at + character.bytes > most) return shown + "...";
        const std::string_view bytes = text.substr(at, character.bytes);
        if (character.valid && !is_control(character.code))
            shown += bytes;
        else
            for (const char byte : bytes)
                shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
        at += character.bytes;
    }
    return shown;
}

// Longer messages repeat a damaged file.
constexpr std::size_t kLongestMessage = 4000;
Error::Error(const std::string& message)
    : std::runtime_error(printable(message, kLongestMessage)) {}

}  // namespace vog
