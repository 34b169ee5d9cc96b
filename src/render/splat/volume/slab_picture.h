// slab_picture.h: One picture by depth slabs: splats of each cell of a tile in the order of the slabs that they begin in,
// added and composited front to back.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <deque>
#include <limits>
#include <vector>

#include "render/splat/projected_splats.h"
#include "render/splat/pyramid/half_picture.h"
#include "render/splat/volume/slab_splats.h"

namespace vog::splat {

/// Splats of a run of Gaussians: as many as fit the bins.
struct SlabBatch {
    ProjectedSplats splats;
    std::vector<SlabSplat> fields;
};

/// Buffers of a thread.
struct SlabBuffers {
    /// Splats of a tile in one batch.
    struct TileSplats {
        std::vector<std::uint32_t> found;
        std::vector<std::uint32_t> begin;  ///< of a counting sort
        std::vector<CellSplat> sorted;     ///< by first slab
        std::vector<CellSplat> in_cells;   ///< by cell, then by first slab
        std::array<std::uint32_t, kCellColumns * kCellRows + 1> cell_begin{};
    };
    SlabCell cell;
    std::vector<TileSplats> of_batch;
    std::vector<const NearSplat*> near;  ///< of the tile
    std::vector<CellRun> runs;           ///< [batches] of a cell
};

/// Sums of a picture, which are finished again under another transfer function or light.
class KeptSums {
  public:
    /// Memory that they take at most, bytes.
    static constexpr std::size_t kMostBytes = std::size_t{1} << 30;

    /// Forgets all; tiles and depths of a picture that follows.
    void begin(int tiles, const SlabDepths& depths);
    const SlabDepths& depths() const { return depths_; }
    /// Adds a cell of tile t. For one thread per tile.
    void add(int t, const SlabCell& cell);
    /// Whether all cells are here: they had enough memory.
    bool complete() const { return !tiles_.empty() && bytes_ <= kMostBytes; }
    int tiles() const { return static_cast<int>(tiles_.size()); }
    /// Calls visit() once for each cell of tile t, whose sums it puts into `cell`, all 0 before and after.
    template <class Visit>
    void each_cell(int t, SlabCell& cell, const Visit& visit) const {
        for (const Kept& kept : tiles_[static_cast<std::size_t>(t)]) {
            cell.column = kept.column, cell.row = kept.row, cell.rows = kAllRows;
            cell.touch(kept.lowest, kept.highest);
            std::ranges::copy(kept.planes, cell.slab(kept.lowest));
            visit();
        }
    }

  private:
    struct Kept {
        std::int32_t column, row;
        int lowest, highest;
        std::vector<SlabPlane> planes;
    };
    std::vector<std::vector<Kept>> tiles_;
    SlabDepths depths_;
    std::atomic<std::size_t> bytes_ = 0;
};

/// Depths that hold nothing.
inline constexpr DepthRange kNoDepths{std::numeric_limits<float>::infinity(),
                                      -std::numeric_limits<float>::infinity()};

/// Slabs that divide a range of depths, not empty.
SlabDepths slab_depths(const DepthRange& range, int slabs);

/// Halves of the resolution at most.
inline constexpr int kMostHalves = 2;

/// Splats of a picture together.
struct SplatExtent {
    DepthRange depths = kNoDepths;
    /// Pixels of their bounds, and those of splats too narrow for pictures of a half, a quarter, ... of the resolution.
    double area = 0, narrow[kMostHalves] = {};
    void add(const FarSplat& splat);
    void include(const SplatExtent& other);
    /// Halves of the resolution that most of the picture is drawn at.
    int halves() const;
};

/// One picture in progress.
struct SlabPicture {
    const SlabView& view;
    const SplatKernels& kernels;
    const SlabPolynomials& polynomials;
    const std::deque<SlabBatch>& batches;
    SlabDepths depths{};
    const SlabLight* light = nullptr;  ///< null: of a maximum
    double unit = 1;                   ///< SplatModel::unit
    float most_share =
        0;  ///< of a maximum: largest share of the field's range per unit of kTau in a slab

    KeptSums* kept = nullptr;  ///< receives the sums of draw_tile(); null: none are kept
    CellRows* rows = nullptr;  ///< to draw; rows of narrow splats are added; null: all

    /// Projects and bins Gaussians first ... last - 1.
    SplatExtent project(const SplatModel& model, SlabBatch& batch, std::size_t first,
                        std::size_t last) const;
    /// Finds the splats of tile t.
    /// returns  whether there are any
    bool find(int t, SlabBuffers& buffers) const;
    /// Sorts the splats found by cell and slab.
    void divide(int t, SlabBuffers& buffers) const;
    /// Places the buffers' cell at cell n of tile t, with its splats.
    /// returns  whether there is any
    bool begin_cell(int t, int n, SlabBuffers& buffers) const;
    /// Sums of the cell over all slabs.
    void sum_cell(SlabBuffers& buffers) const;
    /// Makes pixels of the sums of a cell, and sets these to 0.
    void finish_cell(SlabCell& cell, Rgba* image) const;
    /// Draws tile t.
    void draw_tile(int t, SlabBuffers& buffers, Rgba* image) const;
    /// Draws a whole picture of complete sums that it kept before.
    void draw_kept(tbb::enumerable_thread_specific<SlabBuffers>& buffers, Rgba* image) const;
    /// Sets the image position of cell n of tile t, and its rows.
    /// returns  whether it lies in the image
    bool place_cell(int t, int n, SlabCell& cell) const;

    const ProjectedSplats& tiles() const { return batches.front().splats; }

  private:
    void add_narrow(const SlabBuffers& buffers, int t) const;
    bool draws_in(int t) const;
    void write(const SlabCell& cell, Rgba* image) const;
};

}  // namespace vog::splat
