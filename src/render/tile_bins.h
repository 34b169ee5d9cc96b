// tile_bins.h: which splats touch which tile of the image: a parallel, stable counting sort.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/splat_kernels.h"

namespace vog {

/// Splats by tile, in their own order: tile t holds index[first[t]] ... index[first[t + 1] - 1].
struct TileBins {
    int columns = 0, rows = 0;
    std::vector<std::uint64_t> first;  ///< [columns * rows + 1]
    std::vector<std::uint32_t> index;
};

/// Tiles a splat touches.
std::uint64_t tiles_touched(const PixelBounds& bounds);

/// The same bins for any number of threads.
TileBins bin_by_tile(std::span<const PixelBounds> bounds, int width, int height);

}  // namespace vog
