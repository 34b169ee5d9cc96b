// image_bytes.h: PNG and EXR files assembled byte by byte from their specifications, to test
// readers with files that vog's writers never produce.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace vog::test {

inline std::string read_bytes(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
    // Some file systems flush a file that is truncated and rewritten.
    std::filesystem::remove(file);
    std::ofstream(file, std::ios::binary) << bytes;
}

inline std::string big_endian(std::uint32_t value) {
    std::string bytes;
    for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift & 0xff);
    return bytes;
}

template <class T>
std::string little_endian(T value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
}

inline std::string png_chunk(const std::string& type, const std::string& data) {
    std::uint32_t crc = 0xffffffff;
    for (const char c : type + data) {
        crc ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
    }
    return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(~crc);
}

/// PNG file.
struct PngBytes {
    std::uint32_t width = 1, height = 1;
    int bit_depth = 8, color_type = 2;
    std::string rows;           ///< rows, each with its filter byte in front
    std::string before_pixels;  ///< additional complete chunks

    /// Bytes of the file; rows are in one uncompressed block, which must be shorter than 64 KiB.
    std::string file() const {
        std::uint32_t low = 1, high = 0;  // Adler-32
        for (const char c : rows) {
            low = (low + static_cast<unsigned char>(c)) % 65521;
            high = (high + low) % 65521;
        }
        const auto size = static_cast<std::uint16_t>(rows.size());
        const std::string header = big_endian(width) + big_endian(height) +
                                   static_cast<char>(bit_depth) + static_cast<char>(color_type) +
                                   std::string(3, '\0');
        const std::string pixels = std::string("\x78\x01\x01") + little_endian(size) +
                                   little_endian(static_cast<std::uint16_t>(~size)) + rows +
                                   big_endian(high << 16 | low);
        return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + before_pixels +
               png_chunk("IDAT", pixels) + png_chunk("IEND", "");
    }
};

/// Types of EXR channels.
enum : std::int32_t { kExrUint = 0, kExrHalf = 1, kExrFloat = 2 };

inline std::string exr_attribute(const std::string& name, const std::string& type,
                                 const std::string& value) {
    return name + '\0' + type + '\0' + little_endian(static_cast<std::int32_t>(value.size())) +
           value;
}

/// EXR file without compression.
struct ExrBytes {
    std::vector<std::pair<std::string, std::int32_t>> channels;  ///< sorted by name
    std::int32_t width = 1, height = 1;
    std::int32_t display_width = 0;  ///< of the display window; 0: `width`
    std::int32_t sampling = 1;
    std::vector<std::string> rows;  ///< each row: all values of the first channel, then the next
    std::string more;               ///< additional attributes

    std::string file() const {
        const auto box = [](std::int32_t w, std::int32_t h) {
            return std::string(8, '\0') + little_endian(w - 1) + little_endian(h - 1);
        };
        std::string list;
        for (const auto& [name, type] : channels)
            list += name + '\0' + little_endian(type) + std::string(4, '\0') +
                    little_endian(sampling) + little_endian(sampling);
        std::string bytes = "\x76\x2f\x31\x01" + little_endian(2) +
                            exr_attribute("channels", "chlist", list + '\0') +
                            exr_attribute("compression", "compression", std::string(1, '\0')) +
                            exr_attribute("dataWindow", "box2i", box(width, height)) +
                            exr_attribute("displayWindow", "box2i",
                                          box(display_width ? display_width : width, height)) +
                            exr_attribute("lineOrder", "lineOrder", std::string(1, '\0')) +
                            exr_attribute("pixelAspectRatio", "float", little_endian(1.0f)) +
                            exr_attribute("screenWindowCenter", "v2f", std::string(8, '\0')) +
                            exr_attribute("screenWindowWidth", "float", little_endian(1.0f)) +
                            more + '\0';
        std::uint64_t offset = bytes.size() + 8 * rows.size();
        std::string chunks;
        for (std::size_t y = 0; y < rows.size(); ++y) {
            bytes += little_endian(offset + chunks.size());
            chunks += little_endian(static_cast<std::int32_t>(y)) +
                      little_endian(static_cast<std::int32_t>(rows[y].size())) + rows[y];
        }
        return bytes + chunks;
    }
};

}  // namespace vog::test
