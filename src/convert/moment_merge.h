// moment_merge.h: from more cells than asked for to as many, by joining neighbours.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "convert/moment_sums.h"

namespace vog {

/// Joins cells of one field, two at a time, those first whose splitting would gain least, until
/// `count` are left. Splits of an octree make eight cells at once, which leaves a budget between
/// two sizes of cells with one part coarse and one fine; halves even that out.
/// cells   of each field, in Morton order
/// scales  of gains, for each field (gain_scale)
void merge_cells(std::span<std::vector<Moments>> cells, std::span<const double> scales,
                 std::size_t count);

}  // namespace vog
