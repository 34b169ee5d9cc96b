// visibility.h: visibility weight of a place: mean over 13 lattice directions of exp(-2 T), T the
// optical depth of the whole column through it, plus a constant.
// V = 1 - exp(-T) saturates, so an error dT shows as exp(-T) dT: cells in thin columns, silhouettes
// and wisps, gain more than those in thick ones.
#pragma once

#include <span>
#include <vector>

#include "convert/moments/cells/lattice_field.h"

namespace vog::moments {

/// Columns through a field along the 13 directions between neighbouring voxels, in bins of at least
/// 4 voxels.
class VisibilityWeight {
  public:
    explicit VisibilityWeight(const LatticeField& field);
    /// Mean over the directions of exp(-2 T), plus kDepthErrorWeight (compare/error_views.h): the
    /// weight of a squared error dT^2 in dV^2 + kDepthErrorWeight dT^2. T is scaled so that the
    /// 99th percentile of all columns is 4, as in pictures.
    /// index  in the field's index space
    double operator()(Vec3d index) const;

  private:
    struct Direction {
        Vec3i step;     ///< between voxels; +1 along `along`
        int along = 0;  ///< axis; columns are binned by where they cross its plane 0
        std::int32_t first[2]{}, size[2]{};
        std::vector<float> bins;  ///< T of each column, then exp(-2 T)

        std::size_t bin(Vec3i place) const;
    };
    Vec3i place_of(Vec3d index) const;  ///< in bin edges from lower_
    /// Mass of a cube no larger than a bin.
    struct Piece {
        Vec3i place;
        float mass;
    };
    std::vector<Piece> pieces(std::span<const Brick> bricks) const;
    void set_bins(std::span<const Piece> pieces, Direction& direction, const Affine& map) const;

    Vec3i lower_;      ///< lower corner of the field, index space
    double edge_ = 4;  ///< edge of a bin, voxels
    std::vector<Direction> directions_;
};

}  // namespace vog::moments
