// scan_files.h: Bytes of small dense images in each format.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include "support/data.h"
#include "support/image_bytes.h"
#include "support/refusal.h"
#include "vog/scan_io.h"

namespace vog::test {

/// Values of 2 x 3 x 4 voxels, x fastest: 1 to 24.
inline constexpr Vec3i kScanSize{2, 3, 4};
inline std::vector<std::int16_t> scan_values(std::int16_t first = 1) {
    std::vector<std::int16_t> values(24);
    for (std::size_t n = 0; n < values.size(); ++n)
        values[n] = static_cast<std::int16_t>(first + static_cast<std::int16_t>(n));
    return values;
}

template <class T>
std::string bytes_of(const std::vector<T>& values, bool big_endian = false) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    if (big_endian)
        for (std::size_t n = 0; n < bytes.size(); n += sizeof(T))
            std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(n),
                         bytes.begin() + static_cast<std::ptrdiff_t>(n + sizeof(T)));
    return bytes;
}

/// The bytes as gzip packs them.
inline std::string gzipped(const std::string& bytes) {
    z_stream zip{};
    deflateInit2(&zip, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
    std::string packed(bytes.size() + 1000, '\0');
    zip.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    zip.avail_in = static_cast<uInt>(bytes.size());
    zip.next_out = reinterpret_cast<Bytef*>(packed.data());
    zip.avail_out = static_cast<uInt>(packed.size());
    deflate(&zip, Z_FINISH);
    packed.resize(zip.total_out);
    deflateEnd(&zip);
    return packed;
}

/// A NIfTI-1 head of 352 bytes, of int16 values.
struct Nifti {
    std::array<std::int16_t, 8> dim{3, 2, 3, 4, 1, 1, 1, 1};
    std::array<float, 8> pixdim{1, 0.5f, 1, 2, 1, 1, 1, 1};
    std::int16_t datatype = 4, qform = 0, sform = 0;
    float slope = 0, inter = 0;
    std::array<float, 6> quatern{};  ///< b, c, d, shifts
    std::array<float, 12> srow{};

    template <class T>
    static void put(std::string& head, std::size_t at, const T& value, bool big_endian) {
        std::string bytes(sizeof(T), '\0');
        std::memcpy(bytes.data(), &value, sizeof(T));
        if (big_endian) std::reverse(bytes.begin(), bytes.end());
        head.replace(at, sizeof(T), bytes);
    }
    std::string head(bool big_endian = false) const {
        std::string bytes(352, '\0');
        const auto set = [&](std::size_t at, auto value) { put(bytes, at, value, big_endian); };
        set(0, std::int32_t{348});
        for (std::size_t n = 0; n < 8; ++n) set(40 + 2 * n, dim[n]), set(76 + 4 * n, pixdim[n]);
        set(70, datatype);
        set(108, 352.0f), set(112, slope), set(116, inter);
        bytes[123] = 2;  // mm
        set(252, qform), set(254, sform);
        for (std::size_t n = 0; n < 6; ++n) set(256 + 4 * n, quatern[n]);
        for (std::size_t n = 0; n < 12; ++n) set(280 + 4 * n, srow[n]);
        bytes.replace(344, 3, "n+1");
        return bytes;
    }
};

/// Value of a voxel; 0 where none is active.
inline float value_at(const Volume& volume, Vec3i voxel) {
    for (const Leaf& leaf : volume.leaves) {
        const Vec3i d = voxel - leaf.origin;
        if (std::min({d.x, d.y, d.z}) >= 0 && std::max({d.x, d.y, d.z}) < kLeafEdge)
            return leaf.value[static_cast<std::size_t>(leaf_offset(d.x, d.y, d.z))];
    }
    return 0;
}

/// Expects 1 to 24 in the order of x, y, z.
inline void expect_counted(const Volume& volume, const std::string& what) {
    EXPECT_EQ(active_voxels(volume), 24u) << what;
    float expected = 1;
    for (int z = 0; z < kScanSize.z; ++z)
        for (int y = 0; y < kScanSize.y; ++y)
            for (int x = 0; x < kScanSize.x; ++x, ++expected)
                EXPECT_EQ(value_at(volume, {x, y, z}), expected) << what;
}

inline void expect_map(const Affine& map, const Affine& expected, double tolerance = 1e-6) {
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(map.linear(r, c), expected.linear(r, c), tolerance) << r << c;
        EXPECT_NEAR(map.translation[r], expected.translation[r], tolerance) << r;
    }
}

inline Volume read_bytes(const TempDir& dir, const std::string& name, const std::string& bytes,
                         const VdbOptions& options = {}) {
    write_bytes(dir / name, bytes);
    return read_volume(dir / name, options);
}

inline Affine diagonal(Vec3d edge, Vec3d origin = {}) {
    return {{{Vec3d{edge.x, 0, 0}, {0, edge.y, 0}, {0, 0, edge.z}}}, origin};
}

inline std::string tiff_entry(std::uint16_t tag, std::uint16_t type, std::uint32_t size,
                              std::uint32_t value) {
    return bytes_of<std::uint16_t>({tag, type}) + bytes_of<std::uint32_t>({size, value});
}
/// A little-endian TIFF of pages with uint16 pixels, one strip each.
/// behind  bytes behind the first page's pixels
/// more    further entries of each page's table, by tiff_entry
inline std::string tiff_of(const std::vector<std::vector<std::uint16_t>>& pages,
                           std::uint16_t width, std::uint16_t height,
                           const std::string& description = "",
                           const std::string& behind_pixels = "", const std::string& more = "") {
    std::string file = "II*";
    const auto put = [&](auto value) {
        file.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    file.push_back('\0');
    put(std::uint32_t{8});
    for (std::size_t n = 0; n < pages.size(); ++n) {
        const bool described = n == 0 && !description.empty();
        const auto count = static_cast<std::uint16_t>((described ? 9 : 8) + more.size() / 12);
        const auto behind = static_cast<std::uint32_t>(file.size() + 2 + 12 * count + 4);
        const auto bytes = static_cast<std::uint32_t>(pages[n].size() * 2);
        const auto text = static_cast<std::uint32_t>(description.size() + 1);
        const auto extra = static_cast<std::uint32_t>(n == 0 ? behind_pixels.size() : 0);
        put(count);
        const auto entry = [&](std::uint16_t tag, std::uint16_t type, std::uint32_t size,
                               std::uint32_t value) { put(tag), put(type), put(size), put(value); };
        entry(256, 3, 1, width), entry(257, 3, 1, height), entry(258, 3, 1, 16);
        entry(259, 3, 1, 1), entry(262, 3, 1, 1);
        if (described) entry(270, 2, text, behind + bytes + extra);
        entry(273, 4, 1, behind), entry(277, 3, 1, 1);
        entry(279, 4, 1, bytes);
        file += more;
        const bool last = n + 1 == pages.size();
        put(last ? std::uint32_t{0} : behind + bytes + extra + (described ? text + text % 2 : 0));
        for (const std::uint16_t v : pages[n]) put(v);
        if (n == 0) file += behind_pixels;
        if (described) file += description + std::string(1 + text % 2, '\0');
    }
    return file;
}

/// A header block of cards, and values behind it.
inline std::string fits_of(const std::vector<std::string>& cards, const std::string& values) {
    constexpr std::size_t kBlock = 2880, kCard = 80;
    std::string file;
    for (const std::string& card : cards) file += card + std::string(kCard - card.size(), ' ');
    file += "END";
    file.resize((file.size() + kBlock - 1) / kBlock * kBlock, ' ');
    file += values;
    file.resize((file.size() + kBlock - 1) / kBlock * kBlock, '\0');
    return file;
}
inline std::string card(const std::string& key, const std::string& value) {
    return fmt::format("{:<8}= {:>20}", key, value);
}
inline std::vector<std::string> cube_cards(const std::string& bits) {
    return {card("SIMPLE", "T"), card("BITPIX", bits), card("NAXIS", "3"),
            card("NAXIS1", "2"), card("NAXIS2", "3"),  card("NAXIS3", "4")};
}

/// Whether this build has the library of a format.
inline bool absent(const std::filesystem::path& file) {
    return refusal([&] { read_volume(file); }).find("this build reads no") != std::string::npos;
}

}  // namespace vog::test
