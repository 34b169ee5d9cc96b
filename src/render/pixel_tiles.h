// pixel_tiles.h: Loop over the 16x16 tiles of a picture, in parallel, with progress.
#pragma once

#include <algorithm>
#include <mutex>

#include "core/parallel.h"
#include "vog/progress.h"

namespace vog {

/// Calls pixel(column, row, part) for every pixel of a picture, tile by tile in parallel, and after
/// each tile, one at a time, merge(part) and progress(fraction of the tiles finished). Tiles are
/// square because neighbouring rays meet the same nodes.
/// Part  of one tile, value-initialised
template <class Part, class Pixel, class Merge>
void for_each_pixel(int width, int height, const Progress& progress, const Pixel& pixel,
                    const Merge& merge) {
    constexpr int kTileEdge = 16;
    const int columns = (width + kTileEdge - 1) / kTileEdge;
    const int tiles = columns * ((height + kTileEdge - 1) / kTileEdge);
    std::mutex mutex;
    int done = 0;
    vog::parallel_for(0, tiles, [&](int tile) {
        const int left = tile % columns * kTileEdge, top = tile / columns * kTileEdge;
        Part part{};
        for (int row = top; row < std::min(top + kTileEdge, height); ++row)
            for (int column = left; column < std::min(left + kTileEdge, width); ++column)
                pixel(column, row, part);
        const std::lock_guard lock(mutex);
        merge(part);
        if (progress) progress(static_cast<double>(++done) / tiles);
    });
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
