// pixel_tiles.h: Loops over the tiles of a picture, 16x16 unless chosen, in parallel, with progress.
#pragma once

#include <algorithm>
#include <mutex>

#include "core/parallel.h"
#include "vog/progress.h"

namespace vog {

/// Whether a pixel is one of the fifth of a picture that estimates take: a knight's move apart in every row and column, so that every other
/// pixel has exactly one of them beside it.
constexpr bool is_fifth(int column, int row) { return (column + 2 * row) % 5 == 0; }

/// Division of a picture into tiles, pixels.
struct PixelTiles {
    int width, height;
    int tile_width = 16, tile_height = 16;
};
/// Calls tile(left, top) for the first pixel of every tile, in parallel, and after each, one at a time,
/// merge(its result) and progress(fraction of the tiles finished).
template <class Tile, class Merge>
void for_each_tile(const PixelTiles& of, const Progress& progress, const Tile& tile,
                   const Merge& merge) {
    const int columns = (of.width + of.tile_width - 1) / of.tile_width;
    const int tiles = columns * ((of.height + of.tile_height - 1) / of.tile_height);
    std::mutex mutex;
    int done = 0;
    vog::parallel_for(0, tiles, [&](int n) {
        const auto part = tile(n % columns * of.tile_width, n / columns * of.tile_height);
        const std::lock_guard lock(mutex);
        merge(part);
        if (progress) progress(static_cast<double>(++done) / tiles);
    });
}

/// Calls pixel(column, row, part) for every pixel of a picture, tile by tile in parallel, and after
/// each tile, one at a time, merge(part) and progress(fraction of the tiles finished). Tiles are
/// square because neighbouring rays meet the same nodes.
/// Part  of one tile, value-initialised
template <class Part, class Pixel, class Merge>
void for_each_pixel(int width, int height, const Progress& progress, const Pixel& pixel,
                    const Merge& merge) {
    const PixelTiles tiles{width, height};
    for_each_tile(
        tiles, progress,
        [&](int left, int top) {
            Part part{};
            for (int row = top; row < std::min(top + tiles.tile_height, height); ++row)
                for (int column = left; column < std::min(left + tiles.tile_width, width); ++column)
                    pixel(column, row, part);
            return part;
        },
        merge);
}

/// The same without parts: pixel(column, row).
template <class Pixel>
void for_each_pixel(int width, int height, const Progress& progress, const Pixel& pixel) {
    struct Nothing {};
    for_each_pixel<Nothing>(
        width, height, progress, [&](int column, int row, Nothing&) { pixel(column, row); },
        [](const Nothing&) {});
}

}  // namespace vog
