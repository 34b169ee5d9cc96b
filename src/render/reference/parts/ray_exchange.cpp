// ray_exchange.cpp: Pieces of rays as packets of floats, and their composition.
#include "render/reference/parts/ray_exchange.h"

#include <array>
#include <bit>
#include <cstdint>

#include "core/parallel.h"

namespace vog::reference {

namespace {

using Packets = std::vector<std::vector<float>>;  ///< [processes]

/// First of the pixels that a process composites.
std::size_t first_pixel(std::size_t pixels, int process, const Collective& processes) {
    return pixels * static_cast<std::size_t>(process) / static_cast<std::size_t>(processes.count);
}

// Depths decide the order of pieces that begin 1e-9 of their depth apart: two floats each, 48 bits.
constexpr std::size_t kPieceFloats = 8;
/// The value without the bits that a float lacks. By its bits: where GCC 12 vectorizes value - double(float(value)), it
/// takes double(float(value)) for the value.
double high_bits(double value) {
    constexpr std::uint64_t kFloatLacks = (std::uint64_t{1} << 29) - 1;
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) & ~kFloatLacks);
}
float low_bits(double value) { return static_cast<float>(value - high_bits(value)); }

void pack(const LitPiece& piece, std::vector<float>& to) {
    const auto [first, last] = piece.segment;
    const ValueLight& light = piece.light;
    const double depth =
        std::min(light.extinction * (last - first), double{std::numeric_limits<float>::max()});
    to.insert(to.end(), {static_cast<float>(high_bits(first)), low_bits(first),
                         static_cast<float>(high_bits(last)), low_bits(last),
                         static_cast<float>(depth), static_cast<float>(light.r),
                         static_cast<float>(light.g), static_cast<float>(light.b)});
}

/// Appends the piece, unless it is too short for its floats.
void unpack(const float* at, std::vector<LitPiece>& to) {
    const Segment segment{double{at[0]} + double{at[1]}, double{at[2]} + double{at[3]}};
    if (segment.empty()) return;
    to.push_back({segment,
                  {double{at[4]} / (segment.last - segment.first), double{at[5]}, double{at[6]},
                   double{at[7]}}});
}

/// Begin of each ray in a packet, and the packet's end.
std::vector<std::size_t> ray_begins(const std::vector<float>& packet, std::size_t rays) {
    std::vector<std::size_t> begins{0};
    for (std::size_t n = 0; n < rays; ++n)
        begins.push_back(begins.back() + 1 +
                         kPieceFloats * static_cast<std::size_t>(packet[begins.back()]));
    return begins;
}

/// Mean light of the rays of each pixel that this process composites, four floats each.
std::vector<float> composite_own(const Packets& from, std::size_t pixels, std::size_t samples) {
    std::vector<std::vector<std::size_t>> begins;
    for (const std::vector<float>& packet : from)
        begins.push_back(ray_begins(packet, pixels * samples));
    std::vector<float> light(4 * pixels);
    vog::parallel_for(std::size_t{0}, pixels, [&](std::size_t pixel) {
        std::array<double, 4> sum{};
        std::vector<LitPiece> pieces;
        for (std::size_t ray = pixel * samples; ray < (pixel + 1) * samples; ++ray) {
            pieces.clear();
            for (std::size_t p = 0; p < from.size(); ++p)
                for (std::size_t at = begins[p][ray] + 1; at < begins[p][ray + 1];
                     at += kPieceFloats)
                    unpack(&from[p][at], pieces);
            Compositor along;
            composite(pieces, 1, along);
            sum[0] += along.r, sum[1] += along.g, sum[2] += along.b, sum[3] += along.transmittance;
        }
        const double share = 1 / static_cast<double>(samples);
        for (std::size_t c = 0; c < 4; ++c)
            light[4 * pixel + c] = static_cast<float>(c < 3 ? share * sum[c] : 1 - share * sum[c]);
    });
    return light;
}

}  // namespace

void RayPieces::close() {
    if (open_ && depth_ > 0) {
        const double opacity = -std::expm1(-depth_);
        pieces_.push_back({run_,
                           {depth_ / (run_.last - run_.first), inside_.r / opacity,
                            inside_.g / opacity, inside_.b / opacity}});
        passed_ *= inside_.transmittance;
    }
    open_ = false;
    inside_ = {};
    depth_ = 0;
}

std::vector<Rgba> composite_parts(std::vector<std::vector<LitPiece>>& rays, std::size_t samples,
                                  const Collective& processes) {
    const std::size_t pixels = rays.size() / samples;
    const auto count = static_cast<std::size_t>(processes.count);
    Packets packets(count);
    for (int p = 0; p < processes.count; ++p) {
        std::vector<float>& to = packets[static_cast<std::size_t>(p)];
        const std::size_t end = first_pixel(pixels, p + 1, processes) * samples;
        for (std::size_t n = first_pixel(pixels, p, processes) * samples; n < end; ++n) {
            to.push_back(static_cast<float>(rays[n].size()));
            for (const LitPiece& piece : rays[n]) pack(piece, to);
            std::vector<LitPiece>().swap(rays[n]);
        }
    }
    rays.clear();
    Packets from = processes.exchange(packets);
    const std::size_t own = first_pixel(pixels, processes.index + 1, processes) -
                            first_pixel(pixels, processes.index, processes);
    packets.assign(count, {});
    packets.front() = composite_own(from, own, samples);
    from = processes.exchange(packets);
    std::vector<Rgba> finished;
    for (const std::vector<float>& packet : from)
        for (std::size_t n = 0; n < packet.size(); n += 4)
            finished.push_back({packet[n], packet[n + 1], packet[n + 2], packet[n + 3]});
    return finished;
}

}  // namespace vog::reference
