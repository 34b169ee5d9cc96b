// label_table.cpp: colours of labels as a transfer function, from the tables of 3D Slicer (.ctbl), FreeSurfer and ITK-SNAP.
#include "shade/values/label_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

#include "vog/error.h"
#include "vog/text.h"

namespace vog::shading {

namespace {

constexpr std::size_t kMostRows = 100000;

/// A row of a table.
struct LabelRow {
    double label = 0;
    std::string name{};
    double r = 0, g = 0, b = 0;  ///< [0, 255]
    double opacity = 0;          ///< [0, 1]
};

/// Words of a line; a name in quotes is one, without them.
std::vector<std::string> words_of(const std::string& line) {
    std::vector<std::string> words;
    std::istringstream rest(line);
    for (std::string word; rest >> word;) {
        if (word.front() == '"') {
            std::string more;
            if (word.size() < 2 || word.back() != '"') {
                std::getline(rest, more, '"');
                word += more + '"';
            }
            word = word.substr(1, word.size() - 2);
        }
        words.push_back(word);
    }
    return words;
}

/// A number in [least, most]; NaN: another word.
double number_in(const std::string& word, double least, double most) {
    double value = NAN;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool whole = fault == std::errc() && end == word.data() + word.size();
    return whole && least <= value && value <= most ? value : NAN;
}

/// ITK-SNAP's rows: label, red, green, blue, opacity [0, 1], visibility, visibility of the mesh, "name".
LabelRow snap_row(const std::vector<std::string>& words) {
    const auto color = [&](std::size_t n) { return number_in(words[n], 0, 255); };
    return {number_in(words[0], -1e9, 1e9),
            words[7],
            color(1),
            color(2),
            color(3),
            number_in(words[4], 0, 1) * number_in(words[5], 0, 1)};
}
/// Slicer's and FreeSurfer's: label, name, red, green, blue, alpha [0, 255].
LabelRow slicer_row(const std::vector<std::string>& words) {
    const auto color = [&](std::size_t n) { return number_in(words[n], 0, 255); };
    return {number_in(words[0], -1e9, 1e9),       words[1], color(2), color(3), color(4),
            words.size() > 5 ? color(5) / 255 : 1};
}

std::vector<LabelRow> rows_of(const std::string& text, const std::string& where) {
    std::vector<LabelRow> rows;
    std::istringstream lines(text);
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        const std::vector<std::string> words = words_of(line);
        if (words.empty() || words[0].front() == '#') continue;
        LabelRow row{.label = NAN};
        if (words.size() == 8) row = snap_row(words);
        if (words.size() == 5 || words.size() == 6) row = slicer_row(words);
        const double sum = row.label + row.r + row.g + row.b + row.opacity;
        if (!std::isfinite(sum) || row.label != std::floor(row.label))
            throw Error(
                fmt::format("{}no transfer function: not JSON, and line {} '{}' is no row of a "
                            "table of labels, 'label name r g b a' as of 3D Slicer or 'label r g b "
                            "opacity visible mesh \"name\"' as of ITK-SNAP",
                            where, number, printable(line, 60)));
        if (rows.size() == kMostRows)
            throw Error(fmt::format("{}more than {} labels", where, kMostRows));
        rows.push_back(std::move(row));
    }
    std::ranges::stable_sort(rows, {}, &LabelRow::label);
    for (std::size_t n = 1; n < rows.size(); ++n)
        if (rows[n].label == rows[n - 1].label)
            throw Error(fmt::format("{}label {} twice", where, rows[n].label));
    // FreeSurfer's opaque labels have an alpha of 0, as all others.
    if (std::ranges::none_of(rows, [](const LabelRow& row) { return row.opacity > 0; }))
        for (LabelRow& row : rows) row.opacity = row.label == 0 ? 0 : 1;
    return rows;
}

/// Whether names are the same but for case, and spaces that tables write as underscores.
bool same_name(const std::string& a, const std::string& b) {
    const auto plain = [](char c) {
        return c == ' ' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    };
    return std::ranges::equal(a, b, {}, plain, plain);
}

std::string names_of(const std::vector<LabelRow>& rows) {
    std::string names;
    for (const LabelRow& row : rows) {
        if (names.size() > 300) return names + ", ...";
        names += (names.empty() ? "" : ", ") + printable(row.name, 40);
    }
    return names;
}

}  // namespace

TransferPoints label_points(const std::string& text, const std::string& only,
                            const std::string& where) {
    const std::vector<LabelRow> rows = rows_of(text, where);
    std::vector<ValueBand> bands;
    for (const LabelRow& row : rows) {
        const bool chosen = only.empty() ? row.opacity > 0 : same_name(row.name, only);
        if (!chosen) continue;
        const auto share = [](double color) { return static_cast<float>(color / 255); };
        bands.push_back({row.label - 0.5, row.label + 0.5, share(row.r), share(row.g), share(row.b),
                         row.opacity > 0 ? row.opacity : 1});
    }
    if (bands.empty() && !only.empty())
        throw Error(fmt::format("{}no label '{}', expected one of {}", where, printable(only, 40),
                                names_of(rows)));
    if (bands.empty()) throw Error(where + "no label is visible");
    TransferPoints read;
    read.points = band_transfer(bands, 1);
    read.points.name = only;
    read.at_values = true;
    read.lower = bands.front().lower, read.upper = bands.back().upper;
    return read;
}

bool is_label_table(const TransferPoints& points) {
    const std::vector<ValueColor>& color = points.points.color;
    bool is_one = points.at_values && !points.has_unit_distance && !color.empty() &&
                  points.points.opacity.size() == 2 * color.size();
    for (std::size_t n = 0; is_one && n < color.size(); n += 2)
        is_one = color[n].value + 0.5 == std::floor(color[n].value + 0.5) &&
                 color[n].value + 1 == color[n + 1].value;
    return is_one;
}

}  // namespace vog::shading
