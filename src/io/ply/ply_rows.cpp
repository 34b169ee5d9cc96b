// ply_rows.cpp: rows of PLY elements in every format of numbers.
#include "io/ply/ply_rows.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string>
#include <string_view>

#include "io/float_of.h"
#include "vog/text.h"

namespace vog::ply {

namespace {

/// Number of a type at `at`, as a double.
double number_at(const char* at, Type type, bool swapped) {
    char bytes[8];
    const std::size_t size = bytes_of(type);
    std::memcpy(bytes, at, size);
    if (swapped) std::reverse(bytes, bytes + size);
    const auto as = [&]<class T>(T value) {
        std::memcpy(&value, bytes, sizeof value);
        return static_cast<double>(value);
    };
    switch (type) {
        case Type::int8:
            return as(std::int8_t{});
        case Type::uint8:
            return as(std::uint8_t{});
        case Type::int16:
            return as(std::int16_t{});
        case Type::uint16:
            return as(std::uint16_t{});
        case Type::int32:
            return as(std::int32_t{});
        case Type::uint32:
            return as(std::uint32_t{});
        case Type::float32:
            return as(float{});
        case Type::float64:
            break;
    }
    return as(double{});
}

[[noreturn]] void fail_short(const std::filesystem::path& file) {
    fail(file, "truncated: cannot be read to its end");
}

/// Next line of an ASCII body that is not empty.
std::string next_line(const std::filesystem::path& file, std::istream& in, const Header& header) {
    for (std::string line; std::getline(in, line, header.line_end);)
        if (line.find_first_not_of(" \t\r") != line.npos) return line;
    fail_short(file);
}

/// Numbers of a line of an ASCII body.
void parse_line(const std::filesystem::path& file, std::string_view line,
                const std::vector<double>& shift, float* to) {
    const std::size_t count = shift.size();
    constexpr std::string_view kBlanks = " \t\r";
    const std::string_view whole = line;
    std::size_t found = 0;
    for (;; ++found) {
        line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
        if (line.empty()) break;
        const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
        double value = 0;
        const auto [stop, code] =
            std::from_chars(word.data() + (word[0] == '+'), word.data() + word.size(), value);
        if (code != std::errc{} || stop != word.data() + word.size())
            fail(file, fmt::format("got '{}', expected a number", printable(word, 40)));
        if (found < count) to[found] = float_of(value - shift[found]);
        line.remove_prefix(word.size());
    }
    if (found != count)
        fail(file, fmt::format("a vertex of {} numbers, expected {}: '{}'", found, count,
                               printable(whole, 60)));
}

/// Moves over rows of an element.
void skip_rows(const std::filesystem::path& file, std::istream& in, const Header& header,
               const Element& element, std::uint64_t count) {
    if (const std::size_t bytes = row_bytes(header, element)) {
        in.seekg(static_cast<std::streamoff>(count * bytes), std::ios::cur);
        return;
    }
    for (std::uint64_t row = 0; row < count; ++row) {
        if (header.format == Format::ascii) {
            next_line(file, in, header);
            continue;
        }
        for (const Property& property : element.properties) {
            double values = 1;
            if (property.is_list) {
                char length[8];
                if (!in.read(length, static_cast<std::streamsize>(bytes_of(property.count))))
                    fail_short(file);
                values = number_at(length, property.count, header.format == Format::big_endian);
            }
            if (!(values >= 0 && values < 1e9)) fail(file, "corrupt: a list of wrong length");
            in.seekg(static_cast<std::streamoff>(values) *
                         static_cast<std::streamoff>(bytes_of(property.type)),
                     std::ios::cur);
        }
    }
}

}  // namespace

std::size_t row_bytes(const Header& header, const Element& element) {
    std::size_t bytes = 0;
    for (const Property& property : element.properties) {
        if (property.is_list || header.format == Format::ascii) return 0;
        bytes += bytes_of(property.type);
    }
    return bytes;
}

void skip_to_vertices(const std::filesystem::path& file, std::istream& in, const Header& header) {
    in.seekg(static_cast<std::streamoff>(header.body_offset));
    for (std::size_t n = 0; n < header.vertex; ++n)
        skip_rows(file, in, header, header.elements[n], header.elements[n].count);
}

void skip_vertices(const std::filesystem::path& file, std::istream& in, const Header& header,
                   std::uint64_t count) {
    skip_rows(file, in, header, header.elements[header.vertex], count);
}

void read_vertices(const std::filesystem::path& file, std::istream& in, const Header& header,
                   std::size_t count, const std::vector<double>& shift, std::vector<float>& rows) {
    const std::vector<Property>& properties = header.elements[header.vertex].properties;
    const std::size_t width = properties.size();
    rows.resize(count * width);
    if (header.format == Format::ascii) {
        for (std::size_t row = 0; row < count; ++row)
            parse_line(file, next_line(file, in, header), shift, rows.data() + row * width);
        return;
    }
    const std::size_t stride = row_bytes(header, header.elements[header.vertex]);
    const auto read = [&](char* to) {
        if (!in.read(to, static_cast<std::streamsize>(count * stride))) fail_short(file);
    };
    const bool swapped = header.format == Format::big_endian;
    const bool floats = std::ranges::all_of(
        properties, [](const Property& property) { return property.type == Type::float32; });
    if (floats && !swapped) return read(reinterpret_cast<char*>(rows.data()));
    std::vector<char> stored(count * stride);
    read(stored.data());
    const char* at = stored.data();
    for (float& number : rows) {
        const std::size_t n = static_cast<std::size_t>(&number - rows.data()) % width;
        const Type type = properties[n].type;
        number = float_of(number_at(at, type, swapped) - shift[n]);
        at += bytes_of(type);
    }
}

}  // namespace vog::ply
