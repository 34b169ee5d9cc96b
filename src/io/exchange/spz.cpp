// spz.cpp: SPZ version 3: a gzip stream of columns. Positions have 24 bits, as many of them fractions as their range
// allows; opacities, colours and logarithms of scales 8; rotations the smallest three components in 10 bits.
// Source: github.com/nianticlabs/spz, README.
#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "io/exchange/splat_files.h"
#include "io/exchange/splat_frame.h"
#include "vog/error.h"

namespace vog::exchange {

namespace {

constexpr int kMostFraction = 24;

/// Number of fractional bits at which all positions fit; below 0: none.
int fraction_bits(const Splats& splats) {
    double most = 0;
    for (const Vec3f m : splats.mean)
        most =
            std::max({most, double{std::abs(m.x)}, double{std::abs(m.y)}, double{std::abs(m.z)}});
    int bits = kMostFraction;
    while (bits >= 0 && std::ldexp(most, bits) > (1 << 23) - 1) --bits;
    return bits;
}

std::uint8_t byte_of(double value) {
    return static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0, 255.0));
}

/// Index of the largest component in the upper two bits, then sign and 9 bits of each other one, x y z w.
std::uint32_t packed(Quat q) {
    const std::array<float, 4> c{q.x, q.y, q.z, q.w};
    std::uint32_t largest = 0;
    for (std::uint32_t k = 1; k < 4; ++k)
        if (std::abs(c[k]) > std::abs(c[largest])) largest = k;
    std::uint32_t bits = largest;
    for (std::uint32_t k = 0; k < 4; ++k) {
        if (k == largest) continue;
        const bool negative = (c[k] < 0) != (c[largest] < 0);
        const auto size = static_cast<std::uint32_t>(
            std::min(511.0f, 511 * std::abs(c[k]) * std::sqrt(2.0f) + 0.5f));
        bits = bits << 10 | (negative ? 1u << 9 : 0u) | size;
    }
    return bits;
}

}  // namespace

void check_spz(const Splats& splats, const std::string& where) {
    const int bits = fraction_bits(splats);
    float least = splats.scale.front().x;
    for (const Vec3f s : splats.scale) least = std::min({least, s.x, s.y, s.z});
    if (bits < 0)
        throw Error(fmt::format(
            "{}: positions beyond 24 bits, 2^23: expected a smaller box (--units box)", where));
    // Scales have 8 bits, sixteenths of logarithms from -10 on.
    float largest = least;
    for (const Vec3f s : splats.scale) largest = std::max({largest, s.x, s.y, s.z});
    if (std::log(double{least}) < -10 - 1.0 / 32 ||
        std::log(double{largest}) > 255 / 16.0 - 10 + 1.0 / 32)
        throw Error(
            fmt::format("{}: standard deviations from {:.3g} to {:.3g}, expected from 4.5e-5 to "
                        "379 (--units box, or larger Gaussians: --budget)",
                        where, least, largest));
    constexpr std::size_t kMost = 200'000'000;
    if (splats.size() > kMost)
        throw Error(fmt::format("{}: {} splats, expected at most {}", where, splats.size(), kMost));
    // A step of positions of at most the smallest standard deviation.
    if (std::ldexp(1.0, -bits) > least)
        throw Error(fmt::format(
            "{}: positions of 24 bits have steps of {:.3g}, the smallest standard deviation is "
            "{:.3g}: expected a smaller box (--units box) or larger Gaussians (--budget)",
            where, std::ldexp(1.0, -bits), least));
}

void write_spz(std::ofstream& out, const Splats& splats, const std::string& frame) {
    const int bits = fraction_bits(splats);
    std::string bytes;
    const auto put = [&](auto value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    put(std::uint32_t{0x5053474e}), put(std::uint32_t{3});
    put(static_cast<std::uint32_t>(splats.size()));
    put(std::uint8_t{0}), put(static_cast<std::uint8_t>(bits)), put(std::uint16_t{0});
    for (const Vec3f m : splats.mean)
        for (int axis = 0; axis < 3; ++axis) {
            const auto fixed =
                static_cast<std::uint32_t>(std::llround(std::ldexp(double{m[axis]}, bits)));
            for (const int shift : {0, 8, 16}) put(static_cast<std::uint8_t>(fixed >> shift));
        }
    for (const float o : splats.opacity) put(byte_of(255 * double{o}));
    constexpr double kColorScale = 0.15;
    for (const Vec3f color : splats.color)
        for (int axis = 0; axis < 3; ++axis)
            put(byte_of(255 * (kColorScale * double{harmonics(color)[axis]} + 0.5)));
    for (const Vec3f s : splats.scale)
        for (int axis = 0; axis < 3; ++axis) put(byte_of(16 * (std::log(double{s[axis]}) + 10)));
    for (const Quat q : splats.rotation) put(packed(q));

    z_stream stream{};
    constexpr int kGzip = 16 + MAX_WBITS, kMemory = 9;
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) !=
        Z_OK)
        throw Error("zlib cannot compress");
    // SPZ has no place for it: the comment of gzip (RFC 1952), which readers skip.
    std::string comment = std::string(kFrameKey) + " " + frame;
    gz_header head{};
    head.comment = reinterpret_cast<Bytef*>(comment.data());
    deflateSetHeader(&stream, &head);
    std::string packed_bytes(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed_bytes.data());
    stream.avail_out = static_cast<uInt>(packed_bytes.size());
    const int result = deflate(&stream, Z_FINISH);
    packed_bytes.resize(stream.total_out);
    deflateEnd(&stream);
    if (result != Z_STREAM_END) throw Error("zlib cannot compress");
    out << packed_bytes;
}

}  // namespace vog::exchange
