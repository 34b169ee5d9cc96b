// column_names.cpp: names of columns by which they are known, and the names and units that heads of formats state.
#include "io/points/column_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <span>

#include "io/points/text_fields.h"
#include "vog/error.h"

namespace vog::point_files {

namespace {

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

/// Name without its unit: "x" of "X [kpc]".
std::string plain_name(const std::string& name) {
    return lower(trimmed(std::string_view(name).substr(0, name.find_first_of("[("))));
}

std::vector<std::size_t> named_three(const Names& names,
                                     std::span<const std::string_view> prefixes) {
    for (const std::string_view prefix : prefixes)
        for (const std::string_view letters : {"xyz", "012"}) {
            if (prefix.empty() && letters == "012") continue;
            std::vector<std::size_t> found;
            std::string repeated;
            for (const char letter : letters) {
                const std::string name = std::string(prefix) + letter;
                const auto at = std::ranges::find(names, name, plain_name);
                if (at == names.end()) break;
                found.push_back(static_cast<std::size_t>(at - names.begin()));
                if (std::ranges::count(names, name, plain_name) > 1) repeated = name;
            }
            if (found.size() < 3) continue;
            if (repeated.empty()) return found;
            throw Error(
                fmt::format("two columns called '{}', expected one, or the numbers of three "
                            "columns (--columns)",
                            repeated));
        }
    return {};
}

/// Text behind `key` in a line of YAML, up to a comma or brace; empty: the line has no such key.
std::string entry_of(std::string_view line, std::string_view key) {
    const std::size_t at = line.find(key);
    if (at == line.npos) return {};
    const std::string_view entry = trimmed(line.substr(at + key.size()));
    if (entry.starts_with('"') || entry.starts_with('\''))
        return std::string(entry.substr(1, entry.find(entry.front(), 1) - 1));
    return std::string(trimmed(entry.substr(0, entry.find_first_of(",}"))));
}

}  // namespace

bool is_number(std::string_view field) {
    double value;
    return parse_number(field, value);
}

bool is_whole(std::string_view field) {
    return !field.empty() && field.find_first_not_of("0123456789") == field.npos;
}

std::string number_name(std::size_t column) { return fmt::format("column{}", column + 1); }

std::vector<std::size_t> position_columns(const Names& names) {
    static constexpr std::string_view kPrefixes[] = {
        "",        "pos_",    "pos",  "position_", "p",           "coord_",
        "points:", "points_", "pos:", "position:", "coordinates_"};
    return named_three(names, kPrefixes);
}

std::vector<std::size_t> velocity_columns(const Names& names) {
    static constexpr std::string_view kPrefixes[] = {
        "v", "vel_", "vel", "velocity_", "vel:", "v_", "velocity:", "velocities_", "velo_"};
    return named_three(names, kPrefixes);
}

bool names_position(const Fields& fields) {
    try {
        return !position_columns(Names(fields.begin(), fields.end())).empty();
    } catch (const Error&) {
        return true;
    }
}

std::string_view without_mark(std::string_view comment) {
    while (!comment.empty() && std::string_view("#%/").find(comment.front()) != comment.npos)
        comment.remove_prefix(1);
    return trimmed(comment);
}

Fields header_fields(std::string_view line, char own) {
    line = without_mark(line);
    for (const char separator : {own, ',', ';', '\t', '\0'}) {
        Fields fields = split_fields(line, separator);
        if (fields.empty()) continue;
        std::string_view& first = fields.front();
        if (const std::size_t colon = first.rfind(": "); colon != first.npos)
            first = trimmed(first.substr(colon + 2));
        if (fields.size() > 1 && first.ends_with(':')) fields.erase(fields.begin());
        if (names_position(fields)) return fields;
    }
    return split_fields(line, own);
}

Names extended_names(std::string_view title) {
    constexpr std::string_view kKey = "properties=";
    const std::size_t at = lower(title).find(kKey);
    if (at == title.npos) return {};
    std::string_view list = title.substr(at + kKey.size());
    if (list.starts_with('"')) list = list.substr(1, list.find('"', 1) - 1);
    list = list.substr(0, list.find_first_of(" \t"));
    Names names;
    while (!list.empty()) {
        const std::string name(take_field(list, ':'));
        take_field(list, ':');  // type
        const std::string_view digits = take_field(list, ':');
        std::size_t count = 0;
        const auto [stop, code] =
            std::from_chars(digits.data(), digits.data() + digits.size(), count);
        constexpr std::size_t kMost = 1000;
        if (code != std::errc{} || stop != digits.data() + digits.size() || count > kMost)
            return {};
        for (std::size_t n = 0; n < count; ++n)
            names.push_back(count == 1   ? name
                            : count == 3 ? name + "_" + "xyz"[n]
                                         : fmt::format("{}_{}", name, n + 1));
    }
    return names;
}

Names counted_names(const Fields& fields) {
    const std::size_t index = !fields.empty() && fields.front().empty();
    if (fields.size() < index + 3) return {};
    Names names;
    for (std::size_t n = 0; n < fields.size(); ++n) {
        if (n >= index && fields[n] != std::to_string(n - index)) return {};
        names.push_back(n >= index && n < index + 3 ? std::string(1, "xyz"[n - index])
                                                    : number_name(n));
    }
    return names;
}

Names ecsv_units(const Fields& comments, const Names& names) {
    Names units(names.size());
    std::string name;  // of the column that the lines are about
    for (const std::string_view comment : comments) {
        const bool begins = comment.starts_with("- {name: ") || comment.starts_with("- name: ");
        if (begins) name = entry_of(comment, "name: ");
        if (comment.starts_with("meta:")) name.clear();
        if (!begins && !comment.starts_with("unit: ")) continue;
        const std::string unit = entry_of(comment, "unit: ");
        for (std::size_t n = 0; n < names.size() && !name.empty(); ++n)
            if (names[n] == name) units[n] = unit;
    }
    return units;
}

}  // namespace vog::point_files
