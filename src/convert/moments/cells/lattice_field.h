// lattice_field.h: what cells are cut from: bricks that tile space, in one index space.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "convert/moments/cells/bricks.h"

namespace vog::moments {

/// Leaves that stay where they are as more come, in arrays of twice the size of the one before.
class StableLeaves {
  public:
    Leaf& add();
    void remove_last() { runs_.back().pop_back(); }

  private:
    std::vector<BigVector<Leaf>> runs_;
};

struct LatticeField {
    BigVector<Brick> bricks;  ///< with mass, in Morton order, disjoint
    StableLeaves leaves;      ///< that bricks refer to and no volume has
    Affine world_from_index;

    double voxel_volume() const { return std::abs(determinant(world_from_index.linear)); }
};

/// Of one volume, which must outlive it.
LatticeField lattice_field(const Volume& volume);

/// Of volumes that do not overlap, and must outlive them: one field for each set of lattices that
/// are one another's halves, quarters, ..., in the index space of the finest, so that its octree
/// takes the voxels of all; a field of its own for each lattice that fits no other. Where bricks of
/// two sizes share a cube, as at the seam of two levels, the larger is divided until its pieces
/// are free of others or can be merged with one of their size.
std::vector<LatticeField> lattice_fields(std::span<const Volume> parts);

}  // namespace vog::moments
