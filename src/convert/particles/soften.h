// soften.h: expectation-maximisation over the particles of a tree: neighbouring Gaussians share them, as voxels in moments/em.
#pragma once

#include <cstddef>
#include <cstdint>

#include "convert/particles/moment_tree.h"

namespace vog::particles {

/// Part of a particle that belongs to a cell.
struct ParticlePart {
    std::uint32_t cell = 0, particle = 0;  ///< indices; of the particle in PointTree::particles
    double share = 0;                      ///< of its mass, (0, 1]
};

/// Takes accelerated steps: particles, in proportion to the cells' densities at their means, are divided among the cells, which then have
/// mass, mean and covariance of their parts. Cells without mass are removed.
/// cells    in the order of the tree, so that those next to each other in it are near each other in space
/// steps    > 0
/// parts    receives the parts of the last step, by cell, 4 to 20 a particle; null: not wanted
/// returns  the same bytes for any number of threads
/// cost     0.4 us a particle and step
void soften(const PointTree& tree, BigVector<Moments>& cells, int steps,
            BigVector<ParticlePart>* parts);

}  // namespace vog::particles
