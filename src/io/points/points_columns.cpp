// points_columns.cpp: roles of the columns of a text file, from header lines or by position.
#include "io/points/points_columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

#include "io/file_extension.h"
#include "io/points/column_names.h"
#include "io/points/points_files.h"
#include "io/points/points_head.h"
#include "io/points/text_fields.h"
#include "vog/error.h"
#include "vog/text.h"
#include "vog/units.h"

namespace vog::point_files {

namespace {

/// Index of a column by name, or by number from 1.
std::size_t find_column(const PointHead& head, const std::string& column) {
    const std::string name = printable(column);
    const auto named = std::ranges::find(head.names, name);
    if (std::ranges::count(head.names, name) > 1)
        throw Error(fmt::format("two columns called '{}', expected its number, 1 to {}", name,
                                head.columns()));
    if (named != head.names.end()) return static_cast<std::size_t>(named - head.names.begin());
    std::size_t number = 0;
    const auto [stop, code] = std::from_chars(column.data(), column.data() + column.size(), number);
    if (code == std::errc{} && stop == column.data() + column.size() && number >= 1 &&
        number <= head.columns())
        return number - 1;
    throw Error(fmt::format("no column '{}', expected 1 to {}{}", column, head.columns(),
                            head.names.empty()
                                ? std::string()
                                : fmt::format(" or one of {}", fmt::join(head.names, ", "))));
}

/// Column of the first coordinate in a file without names: behind the element in chemistry's files.
std::size_t first_coordinate(const PointHead& head) {
    const auto all_rows = [&](std::size_t column, const auto& test) {
        return std::ranges::all_of(head.rows, [&](const auto& row) { return test(row[column]); });
    };
    const auto is_element = [&](const std::string& field) {
        constexpr int kMostElements = 118;
        return is_whole(field) && field.size() <= 3 && std::stoi(field) <= kMostElements;
    };
    if (head.count && all_rows(0, [](const std::string& field) { return !is_number(field); }))
        return 1;
    if (!head.titled || head.columns() < 4 || !all_rows(0, is_element)) return 0;
    // Atomic numbers in place of symbols, unless the coordinates are whole numbers as well.
    for (std::size_t column = 1; column < 4; ++column)
        if (!all_rows(column, is_whole)) return 1;
    throw Error(
        "whole numbers alone: column 1 may be atomic numbers or x, expected --columns 2,3,4 or "
        "--columns 1,2,3");
}

/// Columns of position and, if present, velocity, in the order of their roles: 3 or 6.
/// scan  from a laser scanner
/// note  set where their places name them
std::vector<std::size_t> vector_columns(const PointHead& head, const PointReadOptions& options,
                                        bool scan, std::string& note) {
    std::vector<std::size_t> columns;
    if (!options.columns.empty()) {
        if (options.columns.size() != 3 && options.columns.size() != 6)
            throw Error(fmt::format(
                "{} columns requested, expected 3 (position) or 6 (position and velocity)",
                options.columns.size()));
        for (const std::string& column : options.columns)
            columns.push_back(find_column(head, column));
        return columns;
    }
    if (!head.misfit.empty())
        throw Error(
            fmt::format("{} above lines of {} columns, expected one name each, or the numbers of "
                        "three columns (--columns)",
                        head.misfit, head.columns()));
    if (!head.names.empty()) {
        columns = position_columns(head.names);
        if (columns.empty())
            throw Error(fmt::format(
                "no columns x, y, z among {}, expected them or three named by --columns",
                fmt::join(head.names, ", ")));
        const std::vector<std::size_t> velocity = velocity_columns(head.names);
        columns.insert(columns.end(), velocity.begin(), velocity.end());
        if (head.counted)
            note = fmt::format(
                "columns numbered from 0, without names: {}, {}, {} are x, y, z (--columns names "
                "others)",
                columns[0] + 1, columns[1] + 1, columns[2] + 1);
        return columns;
    }
    // Without names: the first three numbers; of six, the others as velocity, but in scans, which have colours there.
    const std::size_t first = first_coordinate(head), left = head.columns() - first;
    if (left < 3)
        throw Error(
            fmt::format("got {} columns in line {}, expected x y z at least", left, head.line + 1));
    for (std::size_t n = 0; n < (left == 6 && !scan ? 6u : 3u); ++n) columns.push_back(first + n);
    // Lines of an element or nothing before three numbers leave no choice.
    if (left > 3)
        note = fmt::format("no names of columns: {}, {}, {} are x, y, z{} (--columns names others)",
                           first + 1, first + 2, first + 3,
                           columns.size() == 3 ? ""
                                               : fmt::format(" and {}, {}, {} the velocity",
                                                             first + 4, first + 5, first + 6));
    return columns;
}

/// Unit in brackets, as behind a name: "kpc" of "X [kpc]"; empty: none.
std::string unit_in(const std::string& name) {
    const std::size_t open = name.find_first_of("[("), close = name.find_last_of("])");
    if (open == name.npos || close == name.npos || close < open) return {};
    return std::string(trimmed(std::string_view(name).substr(open + 1, close - open - 1)));
}

/// What the head says of a column's unit: in a row of units, or in brackets there or behind the name.
std::array<std::string, 3> stated_units(const PointHead& head, std::size_t column) {
    return {unit_in(head.units[column]), head.units[column], unit_in(head.names[column])};
}

/// Unit of the three columns of a vector; columns in others are converted to the first one's.
/// measures  whether a text is a unit of what they hold: other words in brackets are no units
/// factor    of each column's numbers
/// returns   empty where no column states such a unit
template <class Measures>
std::string unit_of_vector(const PointHead& head, std::span<const std::size_t> columns,
                           const char* what, const char* measure, const Measures& measures,
                           double* factor) {
    std::array<std::string, 3> unit;
    for (std::size_t n = 0; n < 3; ++n)
        for (const std::string& text : stated_units(head, columns[n]))
            if (const std::string name = length_unit_name(text); measures(name) || unit[n].empty())
                unit[n] = name;
    if (std::ranges::none_of(unit, measures)) return {};
    for (std::size_t n = 0; n < 3; ++n) {
        const std::optional<double> to_first = unit_factor(unit[n], unit[0]);
        if (!to_first)
            throw Error(
                fmt::format("columns of {} in units '{}', expected one unit, or units of {}", what,
                            fmt::join(unit, ", "), measure));
        factor[n] = *to_first;
    }
    return unit[0];
}

/// Sets the units that the head states.
void set_units(const PointHead& head, std::span<const std::size_t> vectors, PointColumns& columns) {
    if (head.names.empty()) return;
    const auto is_length = [](const std::string& unit) {
        return unit_factor(unit, "m").has_value();
    };
    const auto is_speed = [](const std::string& unit) {
        return unit_factor(unit, "m/s").has_value();
    };
    columns.length_unit = unit_of_vector(head, vectors.first(3), "positions", "length", is_length,
                                         columns.factor.data());
    if (columns.has_velocity)
        columns.velocity_unit = unit_of_vector(head, vectors.subspan(3), "velocities", "speed",
                                               is_speed, &columns.factor[kFirstVelocity]);
    // A row of words is one of units if it has those of the positions.
    const bool row =
        !columns.length_unit.empty() ||
        std::ranges::all_of(vectors.first(3), [&](std::size_t n) { return head.units[n].empty(); });
    for (std::size_t n = 0; n < columns.role.size(); ++n) {
        if (columns.role[n] < kFirstAttribute) continue;
        const auto [inside, whole, behind] = stated_units(head, n);
        columns.attribute_units[static_cast<std::size_t>(columns.role[n] - kFirstAttribute)] =
            printable(!row || whole.empty() ? behind
                      : inside.empty()      ? whole
                                            : inside);
    }
}

/// Roles of the columns. Columns of text are allowed, and skipped, below a header or in chemistry's format.
void set_roles(const PointHead& head, const PointReadOptions& options, bool scan,
               PointColumns& columns) {
    columns.role.assign(head.columns(), kSkipped);
    const std::vector<std::size_t> vectors = vector_columns(head, options, scan, columns.note);
    for (std::size_t n = 0; n < vectors.size(); ++n) {
        if (columns.role[vectors[n]] != kSkipped)
            throw Error(fmt::format("column {} requested twice", vectors[n] + 1));
        columns.role[vectors[n]] = static_cast<int>(n);
    }
    columns.has_velocity = vectors.size() == 6;
    const bool may_be_text = !head.names.empty() || head.count;
    for (std::size_t n = 0; n < columns.role.size(); ++n) {
        if (columns.role[n] != kSkipped) continue;
        const auto any = [&](const auto& test) {
            return std::ranges::any_of(head.rows, [&](const auto& row) { return test(row[n]); });
        };
        const bool numbers = any(
            [](const std::string& field) { return is_number(field) || has_decimal_comma(field); });
        const bool text = any([](const std::string& field) { return !field.empty(); });
        if (may_be_text && text && !numbers) continue;
        std::string name = head.names.empty() ? number_name(n) : head.names[n];
        if (std::ranges::find(columns.attributes, name) != columns.attributes.end())
            name = number_name(n);
        columns.role[n] = kFirstAttribute + static_cast<int>(columns.attributes.size());
        columns.attributes.push_back(std::move(name));
    }
    columns.attribute_units.resize(columns.attributes.size());
    set_units(head, vectors, columns);
}

}  // namespace

std::string text_extension(const std::filesystem::path& file) {
    const std::string last = lower_extension(file);
    return last == ".gz" ? lower_extension(file.stem()) : last;
}

bool is_text(const std::filesystem::path& file) {
    constexpr std::string_view kExtensions[] = {".xyz", ".extxyz", ".pts",  ".asc", ".txt",
                                                ".dat", ".csv",    ".ecsv", ".tsv"};
    return std::ranges::find(kExtensions, text_extension(file)) != std::end(kExtensions);
}

char own_separator(const std::filesystem::path& file) {
    const std::string extension = text_extension(file);
    if (is_text(file)) return extension == ".tsv" ? '\t' : extension == ".csv" ? ',' : 0;
    throw Error(
        fmt::format("{}: unknown extension '{}', expected .xyz, .extxyz, .pts, .asc, .txt, .dat, "
                    ".csv, .ecsv, .tsv (also .gz), .hdf5 or .vdb",
                    file.string(), extension));
}

PointColumns find_columns(const std::filesystem::path& file, std::string_view text,
                          const PointReadOptions& options, bool title) {
    const char own = own_separator(file);
    try {
        const std::string extension = text_extension(file);
        const PointHead head =
            read_head(text, own, extension == ".xyz" || extension == ".extxyz", title);
        PointColumns columns;
        columns.separator = head.separator;
        columns.first_line = head.line;
        columns.count = head.count;
        columns.count_line = head.count_line;
        columns.may_be_title = head.may_be_title;
        set_roles(head, options, extension == ".pts" || extension == ".asc", columns);
        return columns;
    } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", file.string(), error.what()));
    }
}

}  // namespace vog::point_files
