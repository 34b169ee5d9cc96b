// tile_bins.cpp: Counting sort: counts per chunk, prefix sum over tiles and chunks, scatter.
#include "render/splat/tile_bins.h"

#include <algorithm>

namespace vog::splat {

namespace {

struct TileRect {
    int x0, x1, y0, y1;
    std::uint64_t tiles() const {
        return static_cast<std::uint64_t>(x1 - x0 + 1) * static_cast<std::uint64_t>(y1 - y0 + 1);
    }
};
TileRect tiles_of(const PixelBounds& b) {
    return {b.x0 / kTileWidth, b.x1 / kTileWidth, b.y0 / kTileHeight, b.y1 / kTileHeight};
}

template <class Visit>
void for_each_tile(const TileRect& r, int columns, const Visit& visit) {
    // Most splats touch one tile or two neighbours: no loops here, whose ends are mispredicted.
    const auto at = static_cast<std::size_t>(r.y0 * columns + r.x0);
    if (r.y0 == r.y1 && r.x1 - r.x0 <= 1) {
        visit(at);
        if (r.x1 != r.x0) visit(at + 1);
        return;
    }
    for (int row = r.y0; row <= r.y1; ++row)
        for (int column = r.x0; column <= r.x1; ++column)
            visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(column));
}

int tiles_across(int width) { return (width + kTileWidth - 1) / kTileWidth; }
int tiles_down(int height) { return (height + kTileHeight - 1) / kTileHeight; }

/// Number of tiles above which a splat is wide. A test costs a tile about 1 ns, drawing a splat about
/// 100 ns: from 1/64 of the tiles on, testing in every tile costs less than drawing.
std::uint64_t wide_above(int width, int height) {
    constexpr std::uint64_t kLeast = 64;
    return std::max(kLeast, static_cast<std::uint64_t>(tiles_across(width)) *
                                static_cast<std::uint64_t>(tiles_down(height)) / 64);
}

}  // namespace

std::size_t TileBins::most_splats(int width, int height) {
    constexpr std::uint64_t kMaxEntries = 1 << 25;  // 128 MiB of indices
    return kMaxEntries / wide_above(width, height);
}

void TileBins::start(int width, int height, std::size_t chunks) {
    columns_ = tiles_across(width);
    rows_ = tiles_down(height);
    wide_above_ = wide_above(width, height);
    next_.assign(chunks * static_cast<std::size_t>(tiles()), 0);
    next_wide_.assign(chunks, 0);
}

void TileBins::count(std::size_t chunk, std::span<const PixelBounds> bounds) {
    std::uint32_t* counts = next_.data() + chunk * static_cast<std::size_t>(tiles());
    std::uint32_t wide = 0;
    for (const PixelBounds& b : bounds) {
        const TileRect r = tiles_of(b);
        if (r.tiles() > wide_above_)
            ++wide;
        else
            for_each_tile(r, columns_, [&](std::size_t t) { ++counts[t]; });
    }
    next_wide_[chunk] = wide;
}

void TileBins::place() {
    const auto tile_count = static_cast<std::size_t>(tiles());
    const std::size_t chunks = next_wide_.size();
    first_.resize(tile_count + 1);
    std::uint32_t total = 0;
    for (std::size_t t = 0; t < tile_count; ++t) {
        first_[t] = total;
        for (std::size_t n = 0; n < chunks; ++n) {
            const std::uint32_t count = next_[n * tile_count + t];
            next_[n * tile_count + t] = total;
            total += count;
        }
    }
    first_[tile_count] = total;
    if (index_.size() < total) index_.resize(total);

    std::uint32_t total_wide = 0;
    for (std::uint32_t& next : next_wide_) {
        const std::uint32_t count = next;
        next = total_wide;
        total_wide += count;
    }
    wide_count_ = total_wide;
    if (wide_.size() < total_wide) wide_.resize(total_wide);
}

void TileBins::fill(std::size_t chunk, std::span<const PixelBounds> bounds, std::uint32_t first) {
    std::uint32_t* next = next_.data() + chunk * static_cast<std::size_t>(tiles());
    std::uint32_t wide = next_wide_[chunk];
    for (std::size_t n = 0; n < bounds.size(); ++n) {
        const TileRect r = tiles_of(bounds[n]);
        const std::uint32_t splat = first + static_cast<std::uint32_t>(n);
        if (r.tiles() > wide_above_)
            wide_[wide++] = splat;
        else
            for_each_tile(r, columns_, [&](std::size_t t) { index_[next[t]++] = splat; });
    }
}

}  // namespace vog::splat
