// tile_bins.h: Bins of splats by image tile: a parallel, stable counting sort that keeps its memory
// between pictures.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/splat/splat_kernels.h"

namespace vog::splat {

/// Splats by tile. Order of calls: start(), count() for every chunk of splats, place(), fill() for
/// every chunk; chunks may run in parallel. The bins are the same for any number of threads.
class TileBins {
  public:
    void start(int width, int height, std::size_t chunks);
    void count(std::size_t chunk, std::span<const PixelBounds> bounds);
    void place();
    /// bounds  as counted; bounds[n] is the splat number first + n
    void fill(std::size_t chunk, std::span<const PixelBounds> bounds, std::uint32_t first);

    int columns() const { return columns_; }
    int tiles() const { return columns_ * rows_; }
    /// Splats in this tile, without the wide ones, in the order of chunks and splats.
    std::span<const std::uint32_t> of_tile(int tile) const {
        const auto t = static_cast<std::size_t>(tile);
        return std::span(index_).subspan(first_[t], first_[t + 1] - first_[t]);
    }
    /// Splats that touch many tiles and are not binned, to save memory: every tile tests them.
    std::span<const std::uint32_t> wide() const { return std::span(wide_).first(wide_count_); }

    /// Number of splats that make at most 2^25 entries.
    static std::size_t most_splats(int width, int height);

  private:
    int columns_ = 0, rows_ = 0;
    std::uint64_t wide_above_ = 0;  ///< tiles above which a splat is wide
    std::size_t wide_count_ = 0;
    std::vector<std::uint32_t> next_, next_wide_;  ///< [chunk][tile], [chunk]: counts, then offsets
    std::vector<std::uint32_t> first_, index_, wide_;
};

}  // namespace vog::splat
