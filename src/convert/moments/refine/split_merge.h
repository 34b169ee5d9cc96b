// split_merge.h: cells taken from where they are of little use to where pictures err.
#pragma once

#include <span>

#include "convert/moments/cells/packed_cells.h"
#include "convert/moments/cut/visibility.h"

namespace vog::moments {

/// Parts the cells that err most in two, and joins as many pairs of the others: those that lose
/// least by it, the bound on the Kullback-Leibler divergence that Runnalls gives ("Kullback-Leibler
/// approach to Gaussian mixture reduction", 2007), weighed by what is seen. Moments stay, of the
/// whole and of each cell that is parted or joined; there are as many cells as before.
/// error  of each cell, in any unit
/// share  of the cells that are parted, 0 to 1/3
void split_and_merge(PackedCells& cells, std::span<const float> error, double share,
                     const VisibilityWeight& seen);

}  // namespace vog::moments
