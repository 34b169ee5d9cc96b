// splat_tiles.h: the walk over the tiles of an image, for splats of any kind.
#pragma once

#include <tbb/parallel_for.h>

#include <span>
#include <vector>

#include "render/splat_kernels.h"
#include "render/tile_bins.h"
#include "vog/image.h"

namespace vog {

inline TilePixels tile_pixels(const CameraFrame& frame, int column, int row) {
    TilePixels tile;
    tile.column = column;
    tile.row = row;
    for (int y = 0; y < kTileHeight; ++y)
        for (int x = 0; x < TilePixels::kStride; ++x) {
            const Vec3d d = frame.direction(column + x, row + y);
            tile.slant2[y][x] = static_cast<float>(dot(d, d));
            tile.depth[y][x] = 0;
        }
    return tile;
}

/// Bins `splats` in runs whose tile entries fit the memory bound, calls
/// add_to_tile(const Splat* splats, std::span<const std::uint32_t> index, TilePixels& tile) for
/// every tile they touch, and adds the tiles to `image`.
template <class Splat, class Add>
void add_splats(const std::vector<Splat>& splats, const CameraFrame& frame, DepthImage& image,
                const Add& add_to_tile) {
    constexpr std::uint64_t kMaxEntries = 1 << 24;  // 64 MiB of indices
    std::vector<PixelBounds> bounds;
    for (std::size_t first = 0; first < splats.size();) {
        bounds.clear();
        std::uint64_t entries = 0;
        std::size_t last = first;
        for (; last < splats.size(); ++last) {
            entries += tiles_touched(splats[last].bounds);
            if (entries > kMaxEntries && last > first) break;
            bounds.push_back(splats[last].bounds);
        }
        const TileBins bins = bin_by_tile(bounds, frame.width, frame.height);
        tbb::parallel_for(0, bins.rows * bins.columns, [&](int t) {
            const std::uint64_t begin = bins.first[t], end = bins.first[t + 1];
            if (begin == end) return;
            TilePixels tile =
                tile_pixels(frame, t % bins.columns * kTileWidth, t / bins.columns * kTileHeight);
            add_to_tile(splats.data() + first, std::span(bins.index).subspan(begin, end - begin),
                        tile);
            for (int y = 0; y < kTileHeight && tile.row + y < image.height; ++y)
                for (int x = 0; x < kTileWidth && tile.column + x < image.width; ++x)
                    image.at(tile.column + x, tile.row + y) += tile.depth[y][x];
        });
        first = last;
    }
}

}  // namespace vog
