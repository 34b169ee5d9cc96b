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

/// Line with the names of the columns; those that hold a separator are quoted.
/// separator  0: blanks, in a comment
std::string header(bool velocity, std::span<const std::string> attributes, char separator) {
    const char between = separator ? separator : ' ';
    std::string text = separator ? "" : "# ";
    for (const char* name : {"x", "y", "z"}) text += name, text += between;
    if (velocity)
        for (const char* name : {"vx", "vy", "vz"}) text += name, text += between;
    for (const std::string& name : attributes) {
        const bool quoted = separator && name.find(separator) != name.npos;
        text += quoted ? '"' + name + '"' : name;
        text += between;
    }
    text.back() = '\n';
    return text;
}

/// Whether the reader finds these columns in a file with this header.
bool reads_back(const std::filesystem::path& file, bool velocity,
                std::span<const std::string> attributes, char separator) {
    std::string text = header(velocity, attributes, separator);
    const std::size_t columns = (velocity ? 6 : 3) + attributes.size();
    for (std::size_t n = 0; n < columns; ++n) text += '0', text += separator ? separator : ' ';
    text.back() = '\n';
    try {
        const PointColumns read = find_columns(file, text, {});
        return read.has_velocity == velocity && std::ranges::equal(read.attributes, attributes);
    } catch (const Error&) {
        return false;
    }
}

/// throws vog::Error for the first name that a reader would split, take as a number or for another
void require_names(const std::filesystem::path& file, bool velocity,
                   std::span<const std::string> names, char separator) {
    if (reads_back(file, velocity, names, separator)) return;
    // The shortest list that does not read back ends in the name at fault.
    std::size_t valid = 0, faulty = names.size();
    while (valid + 1 < faulty) {
        const std::size_t middle = (valid + faulty) / 2;
        (reads_back(file, velocity, names.first(middle), separator) ? valid : faulty) = middle;
    }
    throw Error(
        fmt::format("{}: cannot write: attribute name '{}', expected no name of another column and "
                    "no {}",
                    file.string(), printable(names[valid]), separator ? "quotes" : "blanks"));
}

}  // namespace

void write_points_text(const std::filesystem::path& file, const Points& points) {
    if (lower_extension(file) == ".gz")
        throw Error(
            fmt::format("{}: cannot write packed text, expected .xyz, .txt, .dat, .csv or .tsv",
                        file.string()));
    const char own = own_separator(file);
    const char separator = own ? own : ' ';
    const bool velocity = !points.velocity.empty();
    std::vector<std::string> names;
    for (const PointAttribute& attribute : points.attributes) names.push_back(attribute.name);
    require_names(file, velocity, names, own);
    write_file(file, [&](std::ofstream& out) {
        out << header(velocity, names, own);
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
