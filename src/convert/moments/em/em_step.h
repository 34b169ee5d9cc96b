// em_step.h: one accelerated step of expectation-maximisation for a Gaussian mixture over voxels.
// A hard cell owns its voxels, so neighbouring Gaussians leave ripples and steps where they meet.
// In a soft cell every voxel's mass is divided among the Gaussians by their responsibilities, their
// share of the mixture's density there (E step), and each Gaussian gets the moments of its part (M
// step). Mass is conserved; the likelihood of the voxels under the mixture grows.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "convert/moments/cells/packed_cells.h"
#include "convert/moments/em/brick_responsibilities.h"
#include "convert/moments/em/brick_tree.h"
#include "core/bfloat16.h"

namespace vog::moments {

/// Momentum of a run of steps. bfloat16 suffices: it only shifts where the next step starts from,
/// and the M step does not depend on it.
struct EmHistory {
    /// Change of a cell in the last step: mass, mean x y z, covariance xx xy xz yy yz zz.
    using Momentum = std::array<BFloat16, 10>;
    BigVector<Momentum> momenta;  ///< one a cell
    int taken = 0;                ///< steps so far
};

/// EM over the bricks of one field.
class EmSolver {
  public:
    /// bricks  all samples of the field; not copied
    /// shifts  from a cell to its images in a periodic box, index space, which share voxels with the others: at most
    ///         3^3 - 1 (image_shifts)
    explicit EmSolver(std::span<const Brick> bricks, std::vector<Vec3d> shifts = {});
    /// Nesterov extrapolation of every cell, then one EM step. Twelve such steps go as far as
    /// thirty without momentum.
    /// cells   the ones that receive no mass are removed
    /// memory  a few dozen bytes a cell: bricks are processed in batches, and a cell's sums are
    ///         held from the first batch that its support overlaps to the last
    void step(PackedCells& cells, EmHistory& history) const;

    /// Sums of one brick: sets `parts`, [cells of the brick][width], to each cell's share.
    /// brick    index in the bricks
    /// cell     [cells of the brick] index of each, whose kernel is scratch.kernels[n]
    using BrickParts = std::function<void(std::size_t brick, std::span<const std::uint32_t> cell,
                                          BrickScratch& scratch, std::span<double> parts)>;
    /// Sums of any quantities over the bricks that a cell's support overlaps, brick by brick in parallel.
    /// width  sums of a cell
    /// sums   [cells][width], added to; the same bytes for any number of threads
    void add_shares(const PackedCells& cells, std::size_t width, const BrickParts& parts_of,
                    std::span<double> sums) const;

  private:
    struct Pair {
        std::uint32_t brick, cell;
        std::uint32_t shift;  ///< index in shifts_
    };
    /// Batches of bricks that each Gaussian's support overlaps.
    struct Overlaps {
        BigVector<std::uint64_t> batches;          ///< bit b of cell i: it overlaps batch b
        std::vector<std::uint64_t> first_batches;  ///< [chunk] bit b: first batch of some cell
        std::vector<Pair> uncovered;  ///< bricks that no support overlaps, with the nearest cell
        double max_peak = 0;          ///< largest peak of all Gaussians
        std::size_t max_active = 0;   ///< most cells between their first and last batch at once
    };
    /// A cell between its first and its last batch.
    struct ActiveCell {
        std::uint32_t cell, sums;  ///< sums: index in Batch::sums
    };
    struct Batch {
        std::size_t first_brick = 0, end_brick = 0;
        std::vector<ActiveCell> active;        ///< sorted by cell
        BigVector<MomentSums> sums;            ///< active cells' sums so far, about their means
        std::vector<std::uint32_t> free_sums;  ///< indices of unused entries of `sums`
        tbb::enumerable_thread_specific<BrickScratch> scratches{};
    };
    /// A cell, or an image of it, whose support overlaps a brick.
    struct BrickCell {
        std::uint32_t active;  ///< index in Batch::active
        std::uint32_t shift;   ///< index in shifts_
    };
    /// The same of all bricks of a batch, in compressed rows.
    struct BrickLists {
        std::vector<BrickCell> entries;  ///< brick by brick
        std::vector<std::size_t> first;  ///< first entry of each brick, and the end
    };
    static constexpr std::size_t kMostBatches = 64;  ///< bits of a word
    std::uint64_t batch_bit(std::size_t brick) const {
        return std::uint64_t{1} << (brick >> batch_log2_);
    }
    /// Bits of the batches after that of a brick.
    std::uint64_t later_batches(std::size_t brick) const {
        const std::uint64_t bit = batch_bit(brick);
        return ~(bit | (bit - 1));
    }
    /// Calls take(brick, shift) for the bricks that the bounding box of a cell's support overlaps, or that of an image.
    /// begin, end  all bricks, or those of one batch
    template <class Take>
    void for_each_brick(const Moments& cell, std::size_t begin, std::size_t end,
                        const Take& take) const;
    Overlaps find_overlaps(const PackedCells& cells) const;
    /// Adds the cells whose first batch this is to the active ones.
    void activate(const Overlaps& overlaps, Batch& batch) const;
    BrickLists brick_lists(const PackedCells& cells, const Overlaps& overlaps,
                           const Batch& batch) const;
    /// Adds the batch's voxels to the sums of the active cells. Each brick has partial sums of its
    /// own, which are added in the order of bricks: the same bytes for any number of threads.
    void e_step(const PackedCells& cells, double max_peak, const BrickLists& lists,
                Batch& batch) const;
    /// Makes room for the cells that are active at once.
    static void make_room(const Overlaps& overlaps, Batch& batch);
    /// The batch's end.
    std::size_t end_of_batch(std::size_t first_brick) const;
    /// Sets the scratch's kernels to the cells of brick n of the batch.
    void set_kernels(const PackedCells& cells, double max_peak, const BrickLists& lists,
                     const Batch& batch, std::size_t n, BrickScratch& scratch) const;
    /// Releases the sums of the active cells whose last batch this is.
    void release(const Overlaps& overlaps, Batch& batch) const;
    /// Sets the moments of the active cells whose last batch this is, and releases their sums.
    void m_step(PackedCells& cells, const Overlaps& overlaps, Batch& batch,
                EmHistory& history) const;

    std::span<const Brick> bricks_;
    std::vector<Vec3d> shifts_;  ///< first that of the cell itself, 0
    int batch_log2_ = 5;         ///< log2 of bricks per batch; at least 32, work for its threads
    BrickTree tree_;
};

}  // namespace vog::moments
