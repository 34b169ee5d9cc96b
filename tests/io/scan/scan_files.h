// scan_files.h: Bytes of small dense images in each format.
#pragma once

#include <zlib.h>

#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include "vog/linear.h"

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

}  // namespace vog::test
