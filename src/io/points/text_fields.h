// text_fields.h: splitting of text into lines and fields without copies, and parsing of numbers.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

namespace vog::point_files {

constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// separator  not removed, as a tab is that stands for an empty field
inline std::string_view trimmed(std::string_view text, char separator = 0) {
    const auto removed = [&](char c) { return is_blank(c) && c != separator; };
    while (!text.empty() && removed(text.front())) text.remove_prefix(1);
    while (!text.empty() && removed(text.back())) text.remove_suffix(1);
    return text;
}

/// Whether a trimmed line is empty, as of a spreadsheet with separators alone, or a comment (#, % or //). Values that a spreadsheet
/// could not work out are no comments.
inline bool is_comment_or_empty(std::string_view trimmed_line, char separator = 0) {
    for (const std::string_view value :
         {"#N/A", "#DIV/0!", "#NAME?", "#NULL!", "#NUM!", "#REF!", "#VALUE!"})
        if (trimmed_line.starts_with(value)) return false;
    const char* blanks = separator == '\t' ? " \t" : separator == ';' ? " \t;" : " \t,";
    return trimmed_line.empty() || trimmed_line.front() == '#' || trimmed_line.front() == '%' ||
           trimmed_line.starts_with("//") ||
           (separator && trimmed_line.find_first_not_of(blanks) == trimmed_line.npos);
}

/// Whether a line starts at `at`, 1 to text.size(): after LF, or after CR without LF.
inline bool starts_line(std::string_view text, std::size_t at) {
    return text[at - 1] == '\n' ||
           (text[at - 1] == '\r' && (at == text.size() || text[at] != '\n'));
}

/// Removes the first line from `text`, which ends in LF, CR LF or CR; returns it without its end.
inline std::string_view take_line(std::string_view& text) {
    std::size_t size = 0;
    while (size < text.size() && text[size] != '\n' && text[size] != '\r') ++size;
    const std::string_view line = text.substr(0, size);
    text.remove_prefix(size);
    text.remove_prefix(text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1);
    return line;
}

/// Removes the first field from a line and returns it.
/// line       must not start with a blank if separator is 0
/// separator  0: fields between runs of blanks; else fields may be empty or quoted
inline std::string_view take_field(std::string_view& line, char separator) {
    const auto unquoted = [](std::string_view field) {
        const bool quoted = field.size() >= 2 && field.front() == '"' && field.back() == '"';
        return quoted ? field.substr(1, field.size() - 2) : field;
    };
    std::size_t end = 0;
    if (separator == 0) {
        while (end < line.size() && !is_blank(line[end])) ++end;
        const std::string_view field = line.substr(0, end);
        while (end < line.size() && is_blank(line[end])) ++end;
        line.remove_prefix(end);
        return unquoted(field);
    }
    bool quoted = false;
    for (; end < line.size() && (quoted || line[end] != separator); ++end)
        if (line[end] == '"') quoted = !quoted;
    const std::string_view field = trimmed(line.substr(0, end));
    line.remove_prefix(std::min(end + 1, line.size()));
    return unquoted(field);
}

inline std::vector<std::string_view> split_fields(std::string_view line, char separator) {
    std::vector<std::string_view> fields;
    line = trimmed(line, separator);
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

/// Whether a field stands for a missing value, as tables of R, astropy and databases have it.
inline bool is_missing(std::string_view field) {
    for (const std::string_view word : {"", "NA", "N/A", "null", "NULL", "None", "--", "\\N"})
        if (field == word) return true;
    return false;
}

/// Whether a field is a number with a decimal comma, as in 1,5 or 1.234,5.
inline bool has_decimal_comma(std::string_view field) {
    const std::size_t comma = field.find(',');
    if (comma >= field.size() - 1 || field.find_first_of("0123456789", comma) != comma + 1)
        return false;
    std::string point(field);
    point[comma] = '.';
    point.erase(std::remove(point.begin(), point.begin() + std::ptrdiff_t(comma), '.'),
                point.begin() + std::ptrdiff_t(comma));
    double value;
    return parse_number(point, value);
}

}  // namespace vog::point_files
