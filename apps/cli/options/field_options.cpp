// field_options.cpp: names, files and grids in the text of a field.
#include "options/field_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>

#include "files/inputs.h"
#include "vog/scan_io.h"
#include "vog/text.h"

namespace vog::cli {

namespace fs = std::filesystem;

namespace {

constexpr const char* kForms = "expected GRID, FILE:GRID or NAME=FILE:GRID";

[[noreturn]] void refuse(const std::string& text, const std::string& what) {
    throw UsageError(fmt::format("--field '{}': {}", printable(text), what));
}

bool is_file(const std::string& path) {
    std::error_code code;
    return fs::is_regular_file(path, code);
}

/// File and grid of FILE:GRID, by the longest part before a colon that is accepted as a file.
template <class Accept>
std::optional<FieldSource> split_at_colon(const std::string& text, const Accept& accept) {
    for (std::size_t colon = text.rfind(':'); colon != text.npos && colon > 0;
         colon = text.rfind(':', colon - 1))
        if (accept(text.substr(0, colon)))
            return FieldSource{.file = text.substr(0, colon), .grid = text.substr(colon + 1)};
    return std::nullopt;
}

/// Source by a file that exists.
std::optional<FieldSource> existing(const std::string& text) {
    if (is_file(text)) return FieldSource{.file = text};
    return split_at_colon(text, is_file);
}

/// Columns of Gaussians in PLY files, which a field would hide.
bool is_reserved(const std::string& name) {
    for (const char* column : {"x", "y", "z", "nx", "ny", "nz", "opacity", "cutoff"})
        if (name == column) return true;
    for (const char* prefix : {"scale_", "rot_", "f_dc_", "f_rest_", "sigmat", "albedo"})
        if (name.starts_with(prefix)) return true;
    return false;
}

void check_name(const std::string& text, const std::string& name) {
    const auto in_name = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; };
    if (name.empty() || !std::ranges::all_of(name, in_name))
        refuse(text,
               fmt::format(
                   "name '{}' of a field, expected letters, digits, _ and - (NAME=... states one)",
                   printable(name)));
    if (is_reserved(name))
        refuse(
            text,
            fmt::format(
                "name '{}' is reserved for the Gaussians, expected another (NAME=... states one)",
                name));
}

/// throws UsageError where the last field has another's name
template <class Field>
void check_unused(const std::string& text, const std::vector<Field>& fields) {
    const std::string& name = fields.back().name;
    const auto same = [&](const Field& other) { return other.name == name; };
    if (!name.empty() && std::ranges::count_if(fields, same) > 1)
        refuse(text, fmt::format("a second field named '{}', expected a name of its own (NAME=...)",
                                 name));
}

}  // namespace

FieldSource parse_field(const std::string& text) {
    std::optional<FieldSource> source = existing(text);
    std::string name, rest = text;
    if (const std::size_t equals = text.find('='); !source && equals != text.npos) {
        name = text.substr(0, equals);
        rest = text.substr(equals + 1);
        check_name(text, name);
        source = existing(rest);
    }
    if (!source)  // its reader reports the missing file
        source =
            is_volume_file(rest) ? FieldSource{.file = rest} : split_at_colon(rest, is_volume_file);
    if (!source) source = FieldSource{.grid = rest};
    if (rest.empty() || (rest.back() == ':' && source->grid.empty()))
        refuse(text, fmt::format("no grid, {}", kForms));
    source->name = name.empty() ? source->grid : name;
    if (!source->name.empty()) check_name(text, source->name);
    return *source;
}

std::vector<FieldSource> parse_fields(std::span<const std::string> texts) {
    std::vector<FieldSource> sources;
    for (const std::string& text : texts) {
        sources.push_back(parse_field(text));
        check_unused(text, sources);
    }
    return sources;
}

std::vector<PointField> parse_point_fields(std::span<const std::string> texts) {
    std::vector<PointField> fields;
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        const bool named = equals != text.npos;
        PointField& field = fields.emplace_back();
        field.values = named ? text.substr(equals + 1) : text;
        field.name = named ? text.substr(0, equals) : text;
        if (field.values.empty()) refuse(text, "no column, expected COLUMN or NAME=COLUMN");
        check_name(text, field.name);
        check_unused(text, fields);
    }
    return fields;
}

}  // namespace vog::cli
