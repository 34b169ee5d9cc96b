// split_merge.h: split-and-merge of mixture components at a constant count.
#pragma once

#include <span>

#include "convert/moments/cells/packed_cells.h"
#include "convert/moments/cut/visibility.h"

namespace vog::moments {

/// Splits the cells with the largest error in two and merges as many pairs of the others. Pairs
/// have the least upper bound on the Kullback-Leibler divergence by merging (A. Runnalls,
/// "Kullback-Leibler approach to Gaussian mixture reduction", 2007), weighted by visibility /
/// sqrt(mass). Conserves the moments of the whole and of every cell split or pair merged; the count
/// stays.
/// error  of each cell, any unit
/// share  of the cells to split, [0, 1/3]
void split_and_merge(PackedCells& cells, std::span<const float> error, double share,
                     const VisibilityWeight& visibility);

}  // namespace vog::moments
