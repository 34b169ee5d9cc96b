// tile_bins.cpp: count per chunk, prefix over tiles and chunks, scatter.
#include "render/tile_bins.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace vog {

namespace {

template <class Visit>
void for_each_tile(const PixelBounds& b, int columns, const Visit& visit) {
    for (int row = b.y0 / kTileHeight; row <= b.y1 / kTileHeight; ++row)
        for (int column = b.x0 / kTileWidth; column <= b.x1 / kTileWidth; ++column)
            visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(column));
}

}  // namespace

std::uint64_t tiles_touched(const PixelBounds& b) {
    if (b.empty()) return 0;
    return static_cast<std::uint64_t>(b.x1 / kTileWidth - b.x0 / kTileWidth + 1) *
           static_cast<std::uint64_t>(b.y1 / kTileHeight - b.y0 / kTileHeight + 1);
}

TileBins bin_by_tile(std::span<const PixelBounds> bounds, int width, int height) {
    TileBins bins;
    bins.columns = (width + kTileWidth - 1) / kTileWidth;
    bins.rows = (height + kTileHeight - 1) / kTileHeight;
    const std::size_t tiles =
        static_cast<std::size_t>(bins.columns) * static_cast<std::size_t>(bins.rows);

    // A fixed number of chunks, not one per thread: the order within a tile never changes.
    constexpr std::size_t kChunks = 16;
    const std::size_t chunk_size = (bounds.size() + kChunks - 1) / kChunks;
    const auto chunk = [&](std::size_t n) {
        const std::size_t begin = std::min(n * chunk_size, bounds.size());
        return std::pair{begin, std::min(begin + chunk_size, bounds.size())};
    };

    // Count the splats of each chunk in each tile.
    std::vector<std::uint64_t> next(kChunks * tiles, 0);
    tbb::parallel_for(std::size_t{0}, kChunks, [&](std::size_t n) {
        const auto [begin, end] = chunk(n);
        for (std::size_t i = begin; i < end; ++i)
            if (!bounds[i].empty())
                for_each_tile(bounds[i], bins.columns,
                              [&](std::size_t t) { ++next[n * tiles + t]; });
    });

    // Where each chunk's share of each tile begins.
    bins.first.resize(tiles + 1);
    std::uint64_t total = 0;
    for (std::size_t t = 0; t < tiles; ++t) {
        bins.first[t] = total;
        for (std::size_t n = 0; n < kChunks; ++n) {
            const std::uint64_t count = next[n * tiles + t];
            next[n * tiles + t] = total;
            total += count;
        }
    }
    bins.first[tiles] = total;

    bins.index.resize(total);
    tbb::parallel_for(std::size_t{0}, kChunks, [&](std::size_t n) {
        const auto [begin, end] = chunk(n);
        for (std::size_t i = begin; i < end; ++i)
            if (!bounds[i].empty())
                for_each_tile(bounds[i], bins.columns, [&](std::size_t t) {
                    bins.index[next[n * tiles + t]++] = static_cast<std::uint32_t>(i);
                });
    });
    return bins;
}

}  // namespace vog
