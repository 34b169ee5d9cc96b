// moment_soften.h: from hard cells to soft ones, by expectation-maximisation.
// A hard cell gives every voxel to one Gaussian, so neighbours leave ripples and steps where they
// meet. A soft cell takes of each voxel the share that its Gaussian has in the sum of all there,
// then the moments of what it took: mass stays, and the likelihood of the voxels under the sum
// grows.
#pragma once

#include <span>
#include <vector>

#include "convert/moment_bricks.h"

namespace vog {

/// What a run of steps remembers: where the cells were.
struct SoftSteps {
    std::vector<Moments> last;
    int taken = 0;
};

class Softener {
  public:
    /// bricks  every sample of the volume; kept by reference
    explicit Softener(std::span<const Brick> bricks);
    /// Replaces each cell's moments by those of its soft cell, seen from a little further along the
    /// way of the last step: twelve such steps go as far as thirty that start where the last ended.
    /// cells  means as indices; those that get no mass are removed
    void step(std::vector<Moments>& cells, SoftSteps& steps) const;
    void soften(std::vector<Moments>& cells, int steps) const;

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
    void share(std::vector<Moments>& cells) const;
    void find_bricks(const Vec3d& lower, const Vec3d& upper, std::uint32_t cell,
                     std::vector<Pair>& found) const;

    std::span<const Brick> bricks_;
    std::vector<Grid> grids_;  ///< one for each spacing
};

}  // namespace vog
