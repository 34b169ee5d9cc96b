// points_text_write.cpp: particles as text, with the shortest digits that read back exactly.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <span>

#include "core/atomic_file.h"
#include "core/parallel.h"
#include "io/file_extension.h"
#include "io/points/points_columns.h"
#include "io/points/points_files.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::point_files {

namespace {

template <class Number>
void put(std::string& text, Number value, char separator) {
    char digits[32];
    const auto [end, code] = std::to_chars(digits, digits + sizeof digits, value);
    text.append(digits, end);
    text += separator;
}

std::string lines_of(const Points& points, std::size_t first, std::size_t last, char separator) {
    std::string text;
    for (std::size_t n = first; n < last; ++n) {
        for (int axis = 0; axis < 3; ++axis) put(text, points.position[n][axis], separator);
        if (!points.velocity.empty())
            for (int axis = 0; axis < 3; ++axis) put(text, points.velocity[n][axis], separator);
        for (const PointAttribute& attribute : points.attributes)
            attribute.unit == 1 ? put(text, attribute.value[n], separator)
                                : put(text, attribute.unit * double{attribute.value[n]}, separator);
        text.back() = '\n';
    }
    return text;
}

/// Name of a column, and its unit; empty: not known.
struct Column {
    std::string name, unit;
};

std::vector<Column> columns_of(const Points& points) {
    std::vector<Column> columns;
    for (const char* name : {"x", "y", "z"}) columns.push_back({name, points.length_unit});
    if (!points.velocity.empty())
        for (const char* name : {"vx", "vy", "vz"}) columns.push_back({name, points.velocity_unit});
    for (const PointAttribute& one : points.attributes)
        columns.push_back({one.name, one.unit_name});
    return columns;
}

/// Line with the names of the columns, those that hold a separator in quotes, and comments with their units as in ECSV: the first
/// line is the one where other programs look for names.
/// separator  0: blanks, in a comment
std::string header(std::span<const Column> columns, char separator) {
    std::string text = separator ? "" : "# ", units;
    for (const auto& [name, unit] : columns) {
        const bool quoted = separator && name.find(separator) != name.npos;
        text += quoted ? '"' + name + '"' : name;
        text += separator ? separator : ' ';
        const char* quote = name.find_first_of(",}") == name.npos ? "" : "'";
        if (!unit.empty())
            units +=
                fmt::format("# - {{name: {0}{1}{0}, unit: {2}}}\n", quote, name, printable(unit));
    }
    text.back() = '\n';
    return text + units;
}

/// Whether the reader finds these columns in a file with this header.
/// vectors  columns of positions and velocities, 3 or 6
bool reads_back(const std::filesystem::path& file, std::span<const Column> columns,
                std::size_t vectors, char separator) {
    std::string text = header(columns, separator);
    for (std::size_t n = 0; n < columns.size(); ++n)
        text += '0', text += separator ? separator : ' ';
    text.back() = '\n';
    try {
        const PointColumns read = find_columns(file, text, {});
        return read.has_velocity == (vectors == 6) &&
               std::ranges::equal(read.attributes, columns.subspan(vectors), {}, {}, &Column::name);
    } catch (const Error&) {
        return false;
    }
}

/// throws vog::Error for the first name that a reader would split, take as a number or for another
void require_names(const std::filesystem::path& file, std::span<const Column> columns,
                   std::size_t vectors, char separator) {
    if (reads_back(file, columns, vectors, separator)) return;
    // The shortest list that does not read back ends in the name at fault.
    std::size_t valid = vectors, faulty = columns.size();
    while (valid + 1 < faulty) {
        const std::size_t middle = (valid + faulty) / 2;
        (reads_back(file, columns.first(middle), vectors, separator) ? valid : faulty) = middle;
    }
    throw Error(fmt::format(
        "{}: cannot write: attribute name '{}', expected no name of another column and no {}",
        file.string(), printable(columns[valid].name), separator ? "quotes" : "blanks"));
}

}  // namespace

void write_points_text(const std::filesystem::path& file, const Points& points) {
    if (lower_extension(file) == ".gz")
        throw Error(
            fmt::format("{}: cannot write packed text, expected .xyz, .txt, .dat, .csv or .tsv",
                        file.string()));
    const char own = own_separator(file);
    const char separator = own ? own : ' ';
    const std::vector<Column> columns = columns_of(points);
    require_names(file, columns, points.velocity.empty() ? 3 : 6, own);
    write_file(file, [&](std::ofstream& out) {
        out << header(columns, own);
        // 16 chunks at a time, so that the whole text is never in memory.
        constexpr std::size_t kChunk = 1 << 14, kChunks = 16;
        for (std::size_t first = 0; first < points.size(); first += kChunk * kChunks) {
            std::vector<std::string> text(kChunks);
            vog::parallel_for(std::size_t{0}, kChunks, [&](std::size_t n) {
                const std::size_t from = std::min(first + n * kChunk, points.size());
                text[n] = lines_of(points, from, std::min(from + kChunk, points.size()), separator);
            });
            for (const std::string& part : text)
                out.write(part.data(), static_cast<std::streamsize>(part.size()));
        }
    });
}

}  // namespace vog::point_files
