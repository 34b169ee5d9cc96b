// projected_splats.h: The splats of a run of Gaussians, projected in parallel and binned to tiles.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "render/splat/splat_kernels.h"
#include "render/splat/tile_bins.h"

namespace vog::splat {

/// A power of two near the largest T of one Gaussian: peak times largest scale; at most that of two
/// floats.
double unit_of(const Gaussians& gaussians);

/// A run of Gaussians that one task projects, and its splats.
struct SplatChunk {
    std::size_t first = 0, last = 0;  ///< Gaussians
    std::size_t slot = 0, count = 0;  ///< its far splats: far[slot ... slot + count - 1]
    std::vector<NearSplat> near;
};

/// Calls add(indices, count) for the splats that touch tile t.
/// bounds  of all splats
template <class Add>
void visit_bins(const TileBins& bins, std::span<const PixelBounds> bounds, int t,
                const CameraFrame& frame, const Add& add) {
    const int column = t % bins.columns() * kTileWidth, row = t / bins.columns() * kTileHeight;
    const int right = std::min(column + kTileWidth, frame.width) - 1;
    const int bottom = std::min(row + kTileHeight, frame.height) - 1;
    // Splats that touch many tiles are not binned: select those that touch this one.
    constexpr std::size_t kAtOnce = 64;
    std::uint32_t wide[kAtOnce];
    std::size_t wide_count = 0;
    for (const std::uint32_t n : bins.wide()) {
        const PixelBounds& b = bounds[n];
        if (b.x0 > right || b.x1 < column || b.y0 > bottom || b.y1 < row) continue;
        wide[wide_count++] = n;
        if (wide_count == kAtOnce) {
            add(wide, wide_count);
            wide_count = 0;
        }
    }
    add(wide, wide_count);
    add(bins.of_tile(t).data(), bins.of_tile(t).size());
}

/// Buffers are kept from picture to picture.
class ProjectedSplats {
  public:
    /// Projects and bins Gaussians first ... last - 1.
    /// each  called in parallel with every chunk, once projected; may remove far splats, the rest first, and change
    ///       the near ones
    template <class Each>
    void project(const SplatKernels& kernels, const SplatModel& model, const CameraFrame& frame,
                 std::size_t first, std::size_t last, const Each& each);
    /// Calls add_far(indices, count) for the far splats that touch tile t, then add_near(splat) for the near ones, in an
    /// order that does not depend on threads.
    /// returns  whether there is any
    template <class AddFar, class AddNear>
    bool visit(int t, const CameraFrame& frame, const AddFar& add_far,
               const AddNear& add_near) const;
    int column_of(int t) const { return t % bins.columns() * kTileWidth; }
    int row_of(int t) const { return t / bins.columns() * kTileHeight; }

    std::vector<FarSplat> far;
    std::vector<PixelBounds> bounds;
    std::vector<SplatOrigin> origin;  ///< of far splats; filled if keep_origin
    std::vector<NearSplat> near;
    std::vector<PixelBounds> near_bounds;
    TileBins bins, near_bins;
    bool keep_origin = false;

  private:
    std::span<const PixelBounds> bounds_of(const SplatChunk& chunk) const {
        return std::span(bounds).subspan(chunk.slot, chunk.count);
    }
    void split(std::size_t first, std::size_t last);
    void bin(const CameraFrame& frame);

    std::vector<SplatChunk> chunks_;
    std::size_t chunk_count_ = 0;
};

/// Calls body(t) for every tile, in parallel.
template <class Tile, class Body>
void draw_tiles(const TileBins& bins, const Body& body) {
    // 64 tasks: full tiles lie together, and with 8 tasks, TBB's own choice for two threads, one
    // thread was idle for a third of a small model's time.
    constexpr int kTasks = 64;
    const int grain = std::max(1, bins.tiles() / kTasks);
    vog::parallel_for(
        tbb::blocked_range<int>(0, bins.tiles(), static_cast<std::size_t>(grain)),
        [&](const tbb::blocked_range<int>& range) {
            Tile tile;
            for (int t = range.begin(); t < range.end(); ++t) body(t, tile);
        },
        tbb::simple_partitioner());
}

template <class Each>
void ProjectedSplats::project(const SplatKernels& kernels, const SplatModel& model,
                              const CameraFrame& frame, std::size_t first, std::size_t last,
                              const Each& each) {
    split(first, last);
    bins.start(frame.width, frame.height, chunk_count_);
    vog::parallel_for(std::size_t{0}, chunk_count_, [&](std::size_t n) {
        SplatChunk& chunk = chunks_[n];
        chunk.near.clear();
        SplatRun run{far.data() + chunk.slot, bounds.data() + chunk.slot, 0, &chunk.near,
                     keep_origin ? origin.data() + chunk.slot : nullptr};
        kernels.project(model, frame, chunk.first, chunk.last, run);
        chunk.count = run.count;
        each(chunk);
        bins.count(n, bounds_of(chunk));
    });
    bin(frame);
}

template <class AddFar, class AddNear>
bool ProjectedSplats::visit(int t, const CameraFrame& frame, const AddFar& add_far,
                            const AddNear& add_near) const {
    bool touched = false;
    const auto add = [&](const std::uint32_t* index, std::size_t count) {
        if (count == 0) return;
        touched = true;
        add_far(index, count);
    };
    visit_bins(bins, bounds, t, frame, add);
    if (near.empty()) return touched;
    visit_bins(near_bins, near_bounds, t, frame,
               [&](const std::uint32_t* index, std::size_t count) {
                   touched |= count > 0;
                   for (std::size_t n = 0; n < count; ++n) add_near(near[index[n]]);
               });
    return touched;
}

}  // namespace vog::splat
