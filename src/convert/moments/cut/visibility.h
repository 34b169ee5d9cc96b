// visibility.h: how much of what lies at a place is seen. V = 1 - exp(-T) saturates: an error of T
// shows as exp(-T) of it, so that cells are worth more where columns are thin, at silhouettes and
// in wisps, than where others lie before and behind them.
#pragma once

#include <span>
#include <vector>

#include "convert/moments/cells/lattice_field.h"

namespace vog::moments {

/// Depth of the columns through a field along the 13 directions between neighbouring voxels.
class VisibilityWeight {
  public:
    explicit VisibilityWeight(const LatticeField& field);
    /// Mean over the directions of exp(-2 T), the square of what is seen, and a floor; T in units
    /// of the extinction that a picture is shown at.
    /// index  in the field's index space
    double operator()(Vec3d index) const;

  private:
    struct Direction {
        Vec3i step;     ///< from voxel to voxel, +1 along `along`
        int along = 0;  ///< bins are where a line meets this axis's plane 0
        std::int32_t first[2]{}, size[2]{};
        std::vector<float> bins;

        std::size_t bin(Vec3i place) const;
    };
    Vec3i place_of(Vec3d index) const;
    /// No larger than a bin.
    struct Piece {
        Vec3i place;
        float mass;
    };
    std::vector<Piece> pieces(std::span<const Brick> bricks) const;
    void set_bins(std::span<const Piece> pieces, Direction& direction, const Affine& map) const;

    Vec3i lower_;      ///< of the field, an index
    double edge_ = 4;  ///< of a bin, voxels
    std::vector<Direction> directions_;
};

}  // namespace vog::moments
