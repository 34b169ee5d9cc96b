// points_columns.cpp: roles of the columns of a text file, from header lines or by position.
#include "io/points/points_columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <span>

#include "io/file_extension.h"
#include "io/points/text_fields.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::point_files {

namespace {

using Names = std::vector<std::string>;
using Three = std::array<std::size_t, 3>;

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

bool is_number(std::string_view field) {
    double value;
    return parse_number(field, value);
}

/// Header lines and the first particle of a file.
struct Head {
    Names names;             ///< of the columns; empty: unknown
    Names first_line;        ///< fields of the first particle
    std::uint64_t line = 0;  ///< number of the first particle's line, from 0
    /// XYZ files of chemistry: atom count, title, then lines that start with an element.
    bool chemical = false;
};

/// Name of a column that has none, from 0.
std::string number_name(std::size_t column) { return fmt::format("column{}", column + 1); }

/// Fields as column names if they are one per column, no numbers and all distinct; else empty.
Names as_names(const std::vector<std::string_view>& fields, std::size_t columns) {
    Names names;
    for (const std::string_view field : fields)
        names.push_back(field.empty() ? number_name(names.size()) : printable(field));
    Names sorted = names;
    std::ranges::sort(sorted);
    if (names.size() != columns || std::ranges::any_of(names, is_number) ||
        std::ranges::adjacent_find(sorted) != sorted.end())
        return {};
    return names;
}

Head read_head(const std::filesystem::path& file, std::string_view text, char separator) {
    Head head;
    std::vector<std::string_view> headers, comments;
    const bool xyz = text_extension(file) == ".xyz";
    for (; !text.empty(); ++head.line) {
        const std::string_view line = trimmed(take_line(text));
        if (line.empty()) continue;
        if (is_comment_or_empty(line)) {
            comments.push_back(trimmed(line.substr(1)));
            continue;
        }
        const auto fields = split_fields(line, separator);
        if (std::ranges::none_of(fields, is_number)) {
            headers.push_back(line);
            continue;
        }
        const bool is_count = line.find_first_not_of("0123456789") == std::string_view::npos;
        if (xyz && is_count && !head.chemical && headers.empty()) {
            head.chemical = true;
            take_line(text);  // title, any text
            ++head.line;
            continue;
        }
        head.first_line.assign(fields.begin(), fields.end());
        // The first header line that qualifies, as in "x,y,z" above "kpc,kpc,kpc"; else the last
        // comment that does.
        for (const std::string_view header : headers)
            if (head.names.empty())
                head.names = as_names(split_fields(header, separator), fields.size());
        for (auto comment = comments.rbegin(); comment != comments.rend(); ++comment)
            if (head.names.empty())
                head.names = as_names(split_fields(*comment, separator), fields.size());
        return head;
    }
    throw Error(fmt::format("{}: no particles", file.string()));
}

/// Columns named prefix + x, y, z or prefix + 0, 1, 2, for the first prefix that has all three.
std::optional<Three> named_three(const Names& names, std::span<const std::string_view> prefixes) {
    for (const std::string_view prefix : prefixes)
        for (const std::string_view letters : {"xyz", "012"}) {
            Three found;
            std::size_t axis = 0;
            for (; axis < 3; ++axis) {
                const std::string name = std::string(prefix) + letters[axis];
                const auto at = std::ranges::find(names, name, [](auto& n) { return lower(n); });
                if (at == names.end()) break;
                found[axis] = static_cast<std::size_t>(at - names.begin());
            }
            if (axis == 3) return found;
        }
    return std::nullopt;
}

/// Index of a column by name, or by number from 1.
std::size_t find_column(const std::filesystem::path& file, const Head& head,
                        const std::string& column) {
    const auto named = std::ranges::find(head.names, printable(column));
    if (named != head.names.end()) return static_cast<std::size_t>(named - head.names.begin());
    std::size_t number = 0;
    const auto [stop, code] = std::from_chars(column.data(), column.data() + column.size(), number);
    if (code == std::errc{} && stop == column.data() + column.size() && number >= 1 &&
        number <= head.first_line.size())
        return number - 1;
    throw Error(fmt::format(
        "{}: no column '{}', expected 1 to {}{}", file.string(), column, head.first_line.size(),
        head.names.empty() ? std::string()
                           : fmt::format(" or one of {}", fmt::join(head.names, ", "))));
}

/// Columns of position and, if present, velocity, in the order of their roles: 3 or 6.
std::vector<std::size_t> vector_columns(const std::filesystem::path& file, const Head& head,
                                        const PointReadOptions& options) {
    std::vector<std::size_t> columns;
    if (!options.columns.empty()) {
        if (options.columns.size() != 3 && options.columns.size() != 6)
            throw Error(fmt::format(
                "{}: {} columns requested, expected 3 (position) or 6 (position and velocity)",
                file.string(), options.columns.size()));
        for (const std::string& column : options.columns)
            columns.push_back(find_column(file, head, column));
        return columns;
    }
    const auto add = [&](const std::optional<Three>& three) {
        if (three) columns.insert(columns.end(), three->begin(), three->end());
        return three.has_value();
    };
    if (!head.names.empty()) {
        static constexpr std::string_view kPosition[] = {
            "",        "pos_",    "pos",  "position_", "p",           "coord_",
            "points:", "points_", "pos:", "position:", "coordinates_"};
        static constexpr std::string_view kVelocity[] = {
            "v", "vel_", "vel", "velocity_", "vel:", "v_", "velocity:", "velocities_"};
        if (!add(named_three(head.names, kPosition)))
            throw Error(fmt::format(
                "{}: no columns x, y, z among {}, expected them or three named by --columns",
                file.string(), fmt::join(head.names, ", ")));
        add(named_three(head.names, kVelocity));
        return columns;
    }
    // Without names: the first three numbers, or six; in chemistry, behind the element.
    const std::size_t first = head.chemical && !is_number(head.first_line.front()) ? 1 : 0;
    const std::size_t left = head.first_line.size() - first;
    if (left < 3)
        throw Error(fmt::format("{}:{}: got {} columns, expected x y z at least", file.string(),
                                head.line + 1, left));
    for (std::size_t n = 0; n < (left >= 6 ? 6u : 3u); ++n) columns.push_back(first + n);
    return columns;
}

}  // namespace

std::string text_extension(const std::filesystem::path& file) {
    const std::string last = lower_extension(file);
    return last == ".gz" ? lower_extension(file.stem()) : last;
}

char text_separator(const std::filesystem::path& file, std::string_view head) {
    const std::string extension = text_extension(file);
    if (extension == ".tsv") return '\t';
    if (extension == ".xyz" || extension == ".txt" || extension == ".dat") return 0;
    if (extension != ".csv")
        throw Error(fmt::format(
            "{}: unknown extension '{}', expected .xyz, .txt, .dat, .csv, .tsv (also .gz), "
            ".hdf5 or .vdb",
            file.string(), extension));
    while (!head.empty()) {
        const std::string_view line = trimmed(take_line(head));
        if (!is_comment_or_empty(line))
            return line.find(',') == std::string_view::npos &&
                           line.find(';') != std::string_view::npos
                       ? ';'
                       : ',';
    }
    return ',';
}

PointColumns find_columns(const std::filesystem::path& file, std::string_view text,
                          const PointReadOptions& options) {
    PointColumns columns;
    columns.separator = text_separator(file, text);
    const Head head = read_head(file, text, columns.separator);
    columns.first_line = head.line;
    columns.role.assign(head.first_line.size(), kSkipped);

    const std::vector<std::size_t> vectors = vector_columns(file, head, options);
    for (std::size_t n = 0; n < vectors.size(); ++n) {
        if (columns.role[vectors[n]] != kSkipped)
            throw Error(
                fmt::format("{}: column {} requested twice", file.string(), vectors[n] + 1));
        columns.role[vectors[n]] = static_cast<int>(n);
    }
    columns.has_velocity = vectors.size() == 6;

    // Other columns are attributes; text columns are allowed, and skipped, below a header or in
    // chemistry's format.
    const bool may_be_text = !head.names.empty() || head.chemical;
    for (std::size_t n = 0; n < columns.role.size(); ++n) {
        if (columns.role[n] != kSkipped) continue;
        if (may_be_text && !is_number(head.first_line[n])) continue;
        columns.role[n] = kFirstAttribute + static_cast<int>(columns.attributes.size());
        columns.attributes.push_back(head.names.empty() ? number_name(n) : head.names[n]);
    }
    return columns;
}

}  // namespace vog::point_files
