// carried_values.h: sums of carried fields over the cells of an octree.
// A component in units of its field's deviation, shifted to 1 and more, times density is a density too: positive at the
// same voxels. Its lattices have the bricks of the density's, and the mass of a cell is its sum of density times value.
#pragma once

#include <deque>
#include <vector>

#include "convert/moments/moment_job.h"

namespace vog::moments {

class CarriedValues {
  public:
    /// job  must outlive the object
    explicit CarriedValues(const MomentJob& job);
    CarriedValues(const CarriedValues&) = delete;  // bricks refer to the volumes
    CarriedValues& operator=(const CarriedValues&) = delete;
    /// Components at lattice n of MomentJob::fields().
    std::vector<const LatticeField*> at(std::size_t n) const;

  private:
    std::deque<std::vector<Volume>> volumes_;            ///< [components][parts]
    std::vector<std::vector<LatticeField>> components_;  ///< [components][lattices]
};

}  // namespace vog::moments
