// tile_bins.h: which splats touch which tile of the image: a parallel, stable counting sort that
// keeps its memory between frames.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/splat/splat_kernels.h"

namespace vog::splat {

/// Splats by tile. Splats come in chunks, several at once: start(), count() every chunk, place(),
/// fill() every chunk. The bins are the same for any number of threads.
class TileBins {
  public:
    void start(int width, int height, std::size_t chunks);
    void count(std::size_t chunk, std::span<const PixelBounds> bounds);
    void place();
    /// bounds  as counted; bounds[n] is the splat number first + n
    void fill(std::size_t chunk, std::span<const PixelBounds> bounds, std::uint32_t first);

    int columns() const { return columns_; }
    int tiles() const { return columns_ * rows_; }
    /// Splats that touch few tiles and this one, in the order of chunks and splats.
    std::span<const std::uint32_t> of_tile(int tile) const {
        const auto t = static_cast<std::size_t>(tile);
        return std::span(index_).subspan(first_[t], first_[t + 1] - first_[t]);
    }
    /// Splats that touch so many tiles that each tile looks through them itself: they would take
    /// most of the memory.
    std::span<const std::uint32_t> wide() const { return std::span(wide_).first(wide_count_); }

    /// Splats to bin at once so that there are at most 2^25 entries.
    static std::size_t most_splats(int width, int height);

  private:
    int columns_ = 0, rows_ = 0;
    std::uint64_t wide_above_ = 0;  ///< tiles
    std::size_t wide_count_ = 0;
    std::vector<std::uint32_t> next_, next_wide_;  ///< [chunk][tile], [chunk]: counts, then places
    std::vector<std::uint32_t> first_, index_, wide_;
};

}  // namespace vog::splat
