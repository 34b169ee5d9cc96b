// lattice_field.h: disjoint bricks of one or several volumes in one index space.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "convert/moments/cells/bricks.h"

namespace vog::moments {

/// Leaves with stable addresses, in arrays that double in size.
class StableLeaves {
  public:
    Leaf& add();
    void remove_last() { runs_.back().pop_back(); }

  private:
    std::vector<BigVector<Leaf>> runs_;
};

/// Density of the volumes whose lattices share an index space.
struct LatticeField {
    BigVector<Brick> bricks;  ///< with mass, in Morton order, disjoint
    StableLeaves leaves;      ///< resampled ones, which bricks refer to
    Affine world_from_index;
    std::vector<const Volume*> volumes;  ///< coarsest first

    double voxel_volume() const { return std::abs(determinant(world_from_index.linear)); }
};

/// Map from the index space of one of a field's volumes to the field's.
struct LatticeStep {
    double edge = 1;  ///< of the volume's voxels
    Vec3d first;      ///< place of voxel 0

    LatticeStep(const Volume& volume, const LatticeField& field);
    /// sums, center  of a cell about its centre, in the volume's voxels
    Moments operator()(const MomentSums& sums, Vec3d center) const;
};

/// Field of one volume, which must outlive it.
LatticeField lattice_field(const Volume& volume);

/// Fields of disjoint volumes, which must outlive them. Volumes whose voxel sizes differ by powers
/// of two and whose voxel corners coincide share a field, in the index space of the finest, and so
/// an octree; any other volume has a field of its own. Where a brick overlaps a smaller one, as at
/// the seam of two levels, it is divided into eighths until its parts overlap none, or one of their
/// own size, to which they are added.
std::vector<LatticeField> lattice_fields(std::span<const Volume> parts);

}  // namespace vog::moments
