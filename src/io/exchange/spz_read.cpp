// spz_read.cpp: Gaussians of SPZ files, versions 2 to 4: spz.cpp has the layout. Versions 2 and 3 are one gzip stream; version 4
// has a plain header, a table of sizes and a zstd stream for each column.
// Source: github.com/nianticlabs/spz, README.
#include <fmt/core.h>
#include <zlib.h>
#include <zstd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "io/byte_source.h"
#include "io/exchange/splat_density.h"
#include "io/exchange/splat_frame.h"
#include "io/exchange/splat_models.h"
#include "vog/error.h"

namespace vog::exchange {

namespace {

struct SpzHeader {
    std::uint32_t magic, version, count;
    std::uint8_t harmonics, fraction_bits, flags, reserved;
};
static_assert(sizeof(SpzHeader) == 16);
constexpr std::uint8_t kExtended = 2;  ///< flag: records of extensions
/// Bytes of the harmonics of a splat, by their degree.
constexpr std::array<std::size_t, 5> kHarmonics{0, 9, 24, 45, 72};

/// Columns of splats, read in turn.
class Columns {
  public:
    virtual ~Columns() = default;
    /// Reads a column, or a part of one in a gzip stream.
    /// throws  vog::Error if it is shorter
    virtual void take(void* to, std::size_t bytes) = 0;
    /// Reads the harmonics, which are not kept, to the end of the file.
    virtual void finish(const SpzHeader& header) = 0;
    /// Comment of a gzip stream, once something was taken; empty: none.
    virtual std::string comment() const { return {}; }
};

/// A gzip stream.
class GzipReader : public Columns {
  public:
    GzipReader(std::span<const char> bytes, const std::string& name) : name_(name) {
        stream_.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));
        stream_.avail_in = static_cast<uInt>(bytes.size());
        constexpr int kGzip = 16 + MAX_WBITS;
        if (inflateInit2(&stream_, kGzip) != Z_OK) throw Error("zlib cannot decompress");
        head_.comment = comment_.data(), head_.comm_max = static_cast<uInt>(comment_.size() - 1);
        inflateGetHeader(&stream_, &head_);
    }
    ~GzipReader() override { inflateEnd(&stream_); }
    GzipReader(const GzipReader&) = delete;
    GzipReader& operator=(const GzipReader&) = delete;

    void take(void* to, std::size_t bytes) override {
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
    void finish(const SpzHeader& header) override {
        std::vector<char> some(std::size_t{1} << 16);
        for (std::size_t left = kHarmonics[header.harmonics] * header.count; left > 0;) {
            const std::size_t part = std::min(left, some.size());
            take(some.data(), part);
            left -= part;
        }
        // Records of extensions follow.
        if (!(header.flags & kExtended) && !at_end())
            throw Error(fmt::format("{}: longer than its {} splats", name_, header.count));
    }
    std::string comment() const override { return reinterpret_cast<const char*>(comment_.data()); }

  private:
    /// Whether nothing is left.
    bool at_end() {
        char byte = 0;
        stream_.next_out = reinterpret_cast<Bytef*>(&byte);
        stream_.avail_out = 1;
        return inflate(&stream_, Z_SYNC_FLUSH) == Z_STREAM_END && stream_.avail_out == 1;
    }

    z_stream stream_{};
    gz_header head_{};
    std::array<Bytef, 1024> comment_{};  // ends in 0
    std::string name_;
};

/// Streams of version 4 behind their table. Empty columns have none.
class ZstdReader : public Columns {
  public:
    ZstdReader(std::span<const char> bytes, const std::string& name) : bytes_(bytes), name_(name) {
        // Behind the 16 bytes of SpzHeader, whose last byte counts the streams: the place of the table.
        constexpr std::uint64_t kHeader = 32;
        streams_ = static_cast<std::uint8_t>(bytes_[15]);
        table_ = number<std::uint32_t>(16);
        if (table_ < kHeader || table_ + 16 * streams_ > bytes_.size())
            fail(fmt::format("a table of {} streams from byte {} on, in {} bytes", streams_, table_,
                             bytes_.size()));
        next_ = table_ + 16 * streams_;
    }

    void take(void* to, std::size_t bytes) override {
        if (bytes == 0) return;
        const std::span<const char> packed = stream(bytes);
        const std::size_t got = ZSTD_decompress(to, bytes, packed.data(), packed.size());
        if (ZSTD_isError(got) || got != bytes) fail("a stream that zstd cannot decompress");
    }
    void finish(const SpzHeader& header) override {
        if (const std::size_t bytes = kHarmonics[header.harmonics] * header.count) stream(bytes);
        if (next_ != bytes_.size()) fail(fmt::format("{} bytes left", bytes_.size() - next_));
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(fmt::format("{}: SPZ version 4, truncated or corrupt: {}", name_, what));
    }
    template <class T>
    T number(std::uint64_t at) const {
        T value{};
        std::memcpy(&value, bytes_.data() + at, sizeof value);
        return value;
    }
    /// Next stream, of `bytes` when decompressed.
    std::span<const char> stream(std::size_t bytes) {
        if (taken_ == streams_) fail(fmt::format("{} streams, expected more", streams_));
        const auto packed = number<std::uint64_t>(table_ + 16 * taken_),
                   whole = number<std::uint64_t>(table_ + 16 * taken_ + 8);
        ++taken_;
        if (whole != bytes || packed > bytes_.size() - next_)
            fail(fmt::format("a stream of {} bytes, {} packed; expected {}, of the {} left", whole,
                             packed, bytes, bytes_.size() - next_));
        next_ += packed;
        return bytes_.subspan(next_ - packed, packed);
    }

    std::span<const char> bytes_;
    std::string name_;
    std::uint64_t streams_ = 0, table_ = 0, taken_ = 0, next_ = 0;
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
    if (packed.size() < 2 * sizeof(SpzHeader))
        throw Error(fmt::format("{}: {} bytes, truncated or not an SPZ file", name, packed.size()));
    constexpr std::uint32_t kMagic = 0x5053474e;  // "NGSP"
    const std::span<const char> bytes(packed.data(), packed.size());
    SpzHeader header{};
    std::memcpy(&header, packed.data(), sizeof header);
    const bool plain = header.magic == kMagic;
    std::unique_ptr<Columns> columns;
    if (!plain) {
        columns = std::make_unique<GzipReader>(bytes, name);
        columns->take(&header, sizeof header);
    }
    if (header.magic != kMagic) throw Error(fmt::format("{}: not an SPZ file", name));
    if (plain ? header.version != 4 : header.version != 2 && header.version != 3)
        throw Error(
            fmt::format("{}: SPZ version {} {} gzip, expected version 2 or 3 in gzip, or 4 without",
                        name, header.version, plain ? "without" : "in"));
    if (plain) columns = std::make_unique<ZstdReader>(bytes, name);
    if (header.harmonics >= kHarmonics.size() || header.fraction_bits > 24)
        throw Error(fmt::format("{}: corrupt: harmonics of degree {}, {} fractional bits", name,
                                header.harmonics, header.fraction_bits));
    const std::size_t count = header.count, turn = header.version >= 3 ? 4 : 3;
    // Deflate makes at most 1032 bytes of one, zstd a block of 2^17 of four; harmonics follow, and are not read.
    const std::size_t row = 9 + 1 + 3 + 3 + turn, most = plain ? 1 << 15 : 1032;
    if (count * row > most * packed.size())
        throw Error(fmt::format("{}: corrupt: {} splats in {} bytes", name, count, packed.size()));
    BigVector<std::uint8_t> column(count * 9);
    Gaussians model;
    model.mean.resize(count), model.scale.resize(count), model.density.resize(count);
    model.rotation.resize(count);
    columns->take(column.data(), 9 * count);
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
    columns->take(opacity.data(), count);
    columns->take(column.data(), 3 * count);  // colours
    columns->take(column.data(), 3 * count);
    for (std::size_t i = 0; i < count; ++i) {
        for (int axis = 0; axis < 3; ++axis)
            model.scale[i][axis] = std::exp(
                static_cast<float>(column[3 * i + static_cast<std::size_t>(axis)]) / 16 - 10);
        model.density[i] = splat_density(opacity[i] / 255.0, model.scale[i]);
    }
    columns->take(column.data(), turn * count);
    for (std::size_t i = 0; i < count; ++i)
        model.rotation[i] =
            turn == 4 ? smallest_three(&column[4 * i]) : first_three(&column[3 * i]);
    columns->finish(header);
    const std::string comment = columns->comment(), key = std::string(kFrameKey) + " ";
    if (comment.starts_with(key)) try {
            restore_frame(model, std::string_view(comment).substr(key.size()), Upright::y);
        } catch (const Error& error) {
            throw Error(fmt::format("{}: {}", name, error.what()));
        }
    return model;
}

}  // namespace vog::exchange
