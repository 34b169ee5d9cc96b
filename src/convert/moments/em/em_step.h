// em_step.h: from hard cells to soft ones, by expectation-maximisation.
// A hard cell gives every voxel to one Gaussian, so neighbours leave ripples and steps where they
// meet. A soft cell takes of each voxel the share that its Gaussian has in the sum of all there,
// then the moments of what it took: mass stays, and the likelihood of the voxels under the sum
// grows.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "convert/moments/cells/packed_cells.h"
#include "convert/moments/em/brick_responsibilities.h"
#include "core/bfloat16.h"

namespace vog::moments {

/// What a run of steps remembers: how each cell came to where it is. Half floats do: the next step
/// starts from about there, and what it finds does not depend on them.
struct EmHistory {
    using Momentum = std::array<BFloat16, 10>;  ///< mass, x y z, xx xy xz yy yz zz
    BigVector<Momentum> momenta;
    int taken = 0;
};

class EmSolver {
  public:
    /// bricks  every sample of the volume; kept by reference
    explicit EmSolver(std::span<const Brick> bricks);
    /// Replaces each cell's moments by those of its soft cell, seen from a little further along the
    /// way of the last step: twelve such steps go as far as thirty that start where the last ended.
    /// cells  those that get no mass are removed
    /// memory  a few dozen bytes a cell: bricks are gone through in batches, and what cells take is
    ///         held only while a batch is to come that they reach
    void step(PackedCells& cells, EmHistory& steps) const;
    void soften(PackedCells& cells, int steps) const;

  private:
    struct Place {
        Vec3i at;  ///< origin over edge
        std::uint32_t brick;
    };
    struct Grid {
        double spacing = 1;
        std::vector<Place> places;  ///< by x, then y, then z
    };
    struct Pair {
        std::uint32_t brick, cell;
    };
    /// Who reaches what.
    struct Reached {
        BigVector<std::uint64_t> batches;   ///< bit b of cell i: it reaches batch b
        std::vector<std::uint64_t> begins;  ///< bit b of a chunk of cells: one's first batch is b
        std::vector<Pair> lonely;           ///< bricks out of everyone's reach, and who takes them
        double highest = 0;                 ///< peak of all
        std::size_t most_open = 0;          ///< cells between their first and last batch
    };
    /// A cell that has begun to take and is not done, and where its sums are.
    struct Open {
        std::uint32_t cell, sums;
    };
    struct Batch {
        std::size_t first_brick = 0, end_brick = 0;
        std::vector<Open> open;           ///< by cell
        BigVector<MomentSums> sums;       ///< what open cells took so far, about their means
        std::vector<std::uint32_t> free;  ///< sums that are nobody's
        tbb::enumerable_thread_specific<BrickScratch> scratches{};
    };
    /// Who reaches each brick of a batch.
    struct Lists {
        std::vector<std::uint32_t> places;  ///< in Batch::open, one brick's after another's
        std::vector<std::size_t> first;     ///< of each brick, and the end
    };
    static constexpr std::size_t kMostBatches = 64;  ///< the bits of a word
    std::uint64_t batch_bit(std::size_t brick) const {
        return std::uint64_t{1} << (brick >> batch_log2_);
    }
    /// Calls take(brick) for all that a cell may reach.
    template <class Take>
    void for_each_brick(const Moments& cell, const Take& take) const;
    Reached reached_by(const PackedCells& cells) const;
    /// Those whose first batch this is join those that go on.
    void open_cells(const Reached& reached, Batch& batch) const;
    Lists lists_of(const PackedCells& cells, const Reached& reached, const Batch& batch) const;
    /// What each open cell takes of the batch: parts are held apart, then added in the order of
    /// bricks.
    void share(const PackedCells& cells, double highest, const Lists& lists, Batch& batch) const;
    /// Gives those their new moments that no later batch is reached by.
    void settle_done(PackedCells& cells, const Reached& reached, Batch& batch,
                     EmHistory& steps) const;

    std::span<const Brick> bricks_;
    int batch_log2_ = 5;       ///< bricks of a batch: enough for its threads
    std::vector<Grid> grids_;  ///< one for each spacing
};

}  // namespace vog::moments
