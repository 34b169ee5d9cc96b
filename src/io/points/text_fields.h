// text_fields.h: splitting of text into lines and fields without copies, and parsing of numbers.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace vog::point_files {

constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

inline std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

/// Whether a trimmed line is empty or a comment (# or %).
inline bool is_comment_or_empty(std::string_view trimmed_line) {
    return trimmed_line.empty() || trimmed_line.front() == '#' || trimmed_line.front() == '%';
}

/// Removes the first line from `text`; returns it without its newline.
inline std::string_view take_line(std::string_view& text) {
    const auto* end = static_cast<const char*>(std::memchr(text.data(), '\n', text.size()));
    const std::size_t size = end ? static_cast<std::size_t>(end - text.data()) : text.size();
    const std::string_view line = text.substr(0, size);
    text.remove_prefix(end ? size + 1 : size);
    return line;
}

/// Removes the first field from a line and returns it.
/// line       must not start with a blank if separator is 0
/// separator  0: fields between runs of blanks; else fields may be empty or quoted
inline std::string_view take_field(std::string_view& line, char separator) {
    std::size_t end = 0;
    if (separator == 0) {
        while (end < line.size() && !is_blank(line[end])) ++end;
        const std::string_view field = line.substr(0, end);
        while (end < line.size() && is_blank(line[end])) ++end;
        line.remove_prefix(end);
        return field;
    }
    bool quoted = false;
    for (; end < line.size() && (quoted || line[end] != separator); ++end)
        if (line[end] == '"') quoted = !quoted;
    std::string_view field = trimmed(line.substr(0, end));
    line.remove_prefix(std::min(end + 1, line.size()));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
        field = field.substr(1, field.size() - 2);
    return field;
}

inline std::vector<std::string_view> split_fields(std::string_view line, char separator) {
    std::vector<std::string_view> fields;
    line = trimmed(line);
    // A separator at the end of a line is followed by an empty field.
    const bool ends_open = separator && !line.empty() && line.back() == separator;
    while (!line.empty()) fields.push_back(take_field(line, separator));
    if (ends_open) fields.emplace_back();
    return fields;
}

/// Parses a whole field as a number: C's syntax with NaN and infinity, and Fortran's 1.5D+03.
/// Numbers beyond double's range become infinite.
/// returns  false if the field is not a number
inline bool parse_number(std::string_view field, double& value) {
    const char *begin = field.data(), *end = begin + field.size();
    if (begin != end && *begin == '+' && begin + 1 != end && begin[1] != '-') ++begin;
    const auto [stop, code] = std::from_chars(begin, end, value);
    if (code == std::errc{} && stop == end) return true;
    if (code == std::errc::result_out_of_range && stop == end) {
        value = std::strtod(std::string(begin, end).c_str(), nullptr);
        return true;
    }
    if (code != std::errc{} || stop == end || (*stop != 'D' && *stop != 'd')) return false;
    std::string with_e(begin, end);
    with_e[static_cast<std::size_t>(stop - begin)] = 'e';
    return parse_number(with_e, value);
}

}  // namespace vog::point_files
