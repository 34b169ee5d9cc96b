// spz_read.cpp: Gaussians of SPZ files, versions 2 and 3: spz.cpp has the layout.
// Source: github.com/nianticlabs/spz, README.
#include <fmt/core.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "io/byte_source.h"
#include "io/exchange/splat_density.h"
#include "io/exchange/splat_models.h"
#include "vog/error.h"

namespace vog::exchange {

namespace {

struct SpzHeader {
    std::uint32_t magic, version, count;
    std::uint8_t harmonics, fraction_bits, flags, reserved;
};
static_assert(sizeof(SpzHeader) == 16);

/// A gzip stream, read in turn.
class GzipReader {
  public:
    GzipReader(std::span<const char> bytes, const std::string& name) : name_(name) {
        stream_.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));
        stream_.avail_in = static_cast<uInt>(bytes.size());
        constexpr int kGzip = 16 + MAX_WBITS;
        if (inflateInit2(&stream_, kGzip) != Z_OK) throw Error("zlib cannot decompress");
    }
    ~GzipReader() { inflateEnd(&stream_); }
    GzipReader(const GzipReader&) = delete;
    GzipReader& operator=(const GzipReader&) = delete;

    /// throws  vog::Error if the stream ends before
    void take(void* to, std::size_t bytes) {
        stream_.next_out = static_cast<Bytef*>(to);
        stream_.avail_out = static_cast<uInt>(bytes);
        const int result = inflate(&stream_, Z_SYNC_FLUSH);
        if (stream_.avail_out > 0)
            throw Error(
                fmt::format("{}: {}, expected {} bytes more", name_,
                            result == Z_OK || result == Z_BUF_ERROR || result == Z_STREAM_END
                                ? "truncated"
                                : "corrupt, or not an SPZ file (gzip)",
                            stream_.avail_out));
    }
    /// Whether nothing is left.
    bool at_end() {
        char byte = 0;
        stream_.next_out = reinterpret_cast<Bytef*>(&byte);
        stream_.avail_out = 1;
        return inflate(&stream_, Z_SYNC_FLUSH) == Z_STREAM_END && stream_.avail_out == 1;
    }

  private:
    z_stream stream_{};
    std::string name_;
};

/// Version 3: the index of the largest component, x y z w, then signs and 9 bits of the others.
Quat smallest_three(const std::uint8_t* bytes) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, bytes, sizeof bits);
    const std::size_t largest = bits >> 30;
    std::array<float, 4> c{};
    float sum = 0;
    for (std::size_t k = 4; k-- > 0;) {
        if (k == largest) continue;
        const float size = static_cast<float>(bits & 511) / 511 / std::sqrt(2.0f);
        c[k] = bits & 512 ? -size : size;
        sum += size * size;
        bits >>= 10;
    }
    c[largest] = std::sqrt(std::max(0.0f, 1 - sum));
    return {c[3], c[0], c[1], c[2]};
}
/// Version 2: x, y, z of 8 bits, and w above 0.
Quat first_three(const std::uint8_t* bytes) {
    const auto part = [&](int k) { return static_cast<float>(bytes[k]) / 127.5f - 1; };
    const float x = part(0), y = part(1), z = part(2);
    return {std::sqrt(std::max(0.0f, 1 - x * x - y * y - z * z)), x, y, z};
}

}  // namespace

Gaussians read_spz(const std::filesystem::path& file) {
    const std::string name = file.string();
    FileBytes in(file);
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 32;
    if (in.size() >= kMostBytes)
        throw Error(
            fmt::format("{}: {} bytes, expected fewer than 2^32 of an SPZ file", name, in.size()));
    const BigVector<char> packed = in.range(0, in.size());
    GzipReader gzip({packed.data(), packed.size()}, name);
    SpzHeader header{};
    gzip.take(&header, sizeof header);
    if (header.magic != 0x5053474e) throw Error(fmt::format("{}: not an SPZ file", name));
    if (header.version != 2 && header.version != 3)
        throw Error(fmt::format("{}: SPZ of version {}, expected 2 or 3", name, header.version));
    if (header.harmonics > 3 || header.fraction_bits > 24)
        throw Error(fmt::format("{}: corrupt: harmonics of degree {}, {} fractional bits", name,
                                header.harmonics, header.fraction_bits));
    const std::size_t count = header.count, turn = header.version == 3 ? 4 : 3;
    // Deflate makes at most 1032 bytes of one; harmonics follow, and are not read.
    const std::size_t bytes = 9 + 1 + 3 + 3 + turn;
    if (count * bytes > 1032 * packed.size())
        throw Error(fmt::format("{}: corrupt: {} splats in {} bytes", name, count, packed.size()));
    BigVector<std::uint8_t> column(count * 9);
    Gaussians model;
    model.mean.resize(count), model.scale.resize(count), model.density.resize(count);
    model.rotation.resize(count);
    gzip.take(column.data(), 9 * count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::uint8_t* b = &column[9 * i + 3 * axis];
            // The upper byte carries the sign.
            const std::int32_t fixed =
                static_cast<std::int32_t>(std::uint32_t{b[0]} << 8 | std::uint32_t{b[1]} << 16 |
                                          std::uint32_t{b[2]} << 24) >>
                8;
            model.mean[i][static_cast<int>(axis)] =
                std::ldexp(static_cast<float>(fixed), -int{header.fraction_bits});
        }
    BigVector<std::uint8_t> opacity(count);
    gzip.take(opacity.data(), count);
    gzip.take(column.data(), 3 * count);  // colours
    gzip.take(column.data(), 3 * count);
    for (std::size_t i = 0; i < count; ++i) {
        for (int axis = 0; axis < 3; ++axis)
            model.scale[i][axis] = std::exp(
                static_cast<float>(column[3 * i + static_cast<std::size_t>(axis)]) / 16 - 10);
        model.density[i] = splat_density(opacity[i] / 255.0, model.scale[i]);
    }
    gzip.take(column.data(), turn * count);
    for (std::size_t i = 0; i < count; ++i)
        model.rotation[i] =
            turn == 4 ? smallest_three(&column[4 * i]) : first_three(&column[3 * i]);
    constexpr std::array<std::size_t, 4> kHarmonics{0, 9, 24, 45};
    for (std::size_t left = kHarmonics[header.harmonics] * count; left > 0;) {
        const std::size_t some = std::min(left, column.size());
        gzip.take(column.data(), some);
        left -= some;
    }
    if (!gzip.at_end()) throw Error(fmt::format("{}: longer than its {} splats", name, count));
    return model;
}

}  // namespace vog::exchange
