// points_text_write.cpp: particles as text, with the shortest digits that read back exactly.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/atomic_file.h"
#include "core/parallel.h"
#include "io/points/points_columns.h"
#include "io/points/points_files.h"

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
            put(text, attribute.value[n], separator);
        text.back() = '\n';
    }
    return text;
}

std::string header(const Points& points, char separator) {
    std::string text;
    for (const char* name : {"x", "y", "z"}) text += name, text += separator;
    if (!points.velocity.empty())
        for (const char* name : {"vx", "vy", "vz"}) text += name, text += separator;
    for (const PointAttribute& attribute : points.attributes)
        text += attribute.name, text += separator;
    text.back() = '\n';
    return text;
}

}  // namespace

void write_points_text(const std::filesystem::path& file, const Points& points) {
    const char own = text_separator(file, "");
    const char separator = own ? own : ' ';
    write_file(file, [&](std::ofstream& out) {
        out << (own ? "" : "# ") << header(points, separator);
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
