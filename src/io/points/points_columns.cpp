// points_columns.cpp: header lines, column names, and what is guessed without them.
#include "io/points/points_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <span>

#include "io/points/text_fields.h"
#include "vog/error.h"

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

/// The lines before the first particle, and that one.
struct Head {
    Names names;       ///< of the columns; empty: not told
    Names first_line;  ///< fields of the first particle
    std::uint64_t line = 0;
    bool chemical = false;  ///< number of atoms, title, then lines that begin with an element
};

/// Names, if these fields can be: as many as columns, no numbers, no two the same.
Names as_names(const std::vector<std::string_view>& fields, std::size_t columns) {
    Names names(fields.begin(), fields.end());
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
    const bool xyz = lower(file.extension().string()) == ".xyz";
    for (; !text.empty(); ++head.line) {
        const std::string_view line = trimmed(take_line(text));
        if (line.empty()) continue;
        if (says_nothing(line)) {
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
            take_line(text);  // the title, whatever it is
            ++head.line;
            continue;
        }
        head.first_line.assign(fields.begin(), fields.end());
        // Headers come first, as in "x,y,z" over "kpc,kpc,kpc"; of comments the nearest.
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

/// Columns called x, y, z, alone or behind one of the prefixes.
std::optional<Three> named_three(const Names& names, std::span<const std::string_view> prefixes) {
    for (const std::string_view prefix : prefixes)
        for (const std::string_view letters : {"xyz", "012"}) {
            Three found;
            std::size_t axis = 0;
            for (; axis < 3; ++axis) {
                const std::string wanted = std::string(prefix) + letters[axis];
                const auto at = std::ranges::find(names, wanted, [](auto& n) { return lower(n); });
                if (at == names.end()) break;
                found[axis] = static_cast<std::size_t>(at - names.begin());
            }
            if (axis == 3) return found;
        }
    return std::nullopt;
}

/// A column by its name, or by its number from 1.
std::size_t column_asked(const std::filesystem::path& file, const Head& head,
                         const std::string& asked) {
    const auto named = std::ranges::find(head.names, asked);
    if (named != head.names.end()) return static_cast<std::size_t>(named - head.names.begin());
    std::size_t number = 0;
    const auto [stop, code] = std::from_chars(asked.data(), asked.data() + asked.size(), number);
    if (code == std::errc{} && stop == asked.data() + asked.size() && number >= 1 &&
        number <= head.first_line.size())
        return number - 1;
    throw Error(fmt::format(
        "{}: no column '{}', expected 1 to {}{}", file.string(), asked, head.first_line.size(),
        head.names.empty() ? std::string()
                           : fmt::format(" or one of {}", fmt::join(head.names, ", "))));
}

/// Position, and velocity where there is one, in the order of the roles.
std::vector<std::size_t> vector_columns(const std::filesystem::path& file, const Head& head,
                                        const PointReadOptions& options) {
    std::vector<std::size_t> columns;
    if (!options.columns.empty()) {
        if (options.columns.size() != 3 && options.columns.size() != 6)
            throw Error(fmt::format(
                "{}: {} columns asked for, expected 3 (position) or 6 (position and velocity)",
                file.string(), options.columns.size()));
        for (const std::string& asked : options.columns)
            columns.push_back(column_asked(file, head, asked));
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
    // Without names: the first three, behind the element of chemists.
    const std::size_t first = head.chemical && !is_number(head.first_line.front()) ? 1 : 0;
    const std::size_t left = head.first_line.size() - first;
    if (left < 3)
        throw Error(fmt::format("{}:{}: got {} columns, expected x y z at least", file.string(),
                                head.line + 1, left));
    for (std::size_t n = 0; n < (left >= 6 ? 6u : 3u); ++n) columns.push_back(first + n);
    return columns;
}

}  // namespace

char text_separator(const std::filesystem::path& file, std::string_view head) {
    const std::string extension = lower(file.extension().string());
    if (extension == ".tsv") return '\t';
    if (extension == ".xyz" || extension == ".txt" || extension == ".dat") return 0;
    if (extension != ".csv")
        throw Error(
            fmt::format("{}: unknown extension '{}', expected .xyz, .txt, .dat, .csv, .tsv or .vdb",
                        file.string(), extension));
    while (!head.empty()) {
        const std::string_view line = trimmed(take_line(head));
        if (!says_nothing(line))
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
    columns.role.assign(head.first_line.size(), kLeftOut);

    const std::vector<std::size_t> vectors = vector_columns(file, head, options);
    for (std::size_t n = 0; n < vectors.size(); ++n) {
        if (columns.role[vectors[n]] != kLeftOut)
            throw Error(
                fmt::format("{}: column {} asked for twice", file.string(), vectors[n] + 1));
        columns.role[vectors[n]] = static_cast<int>(n);
    }
    columns.has_velocity = vectors.size() == 6;

    // The others hold numbers, or text where a header or chemistry lets one expect it.
    const bool may_be_text = !head.names.empty() || head.chemical;
    for (std::size_t n = 0; n < columns.role.size(); ++n) {
        if (columns.role[n] != kLeftOut) continue;
        if (may_be_text && !is_number(head.first_line[n])) continue;
        columns.role[n] = kFirstAttribute + static_cast<int>(columns.attributes.size());
        columns.attributes.push_back(head.names.empty() ? fmt::format("column{}", n + 1)
                                                        : head.names[n]);
    }
    return columns;
}

}  // namespace vog::point_files
