// periodic_lattice.h: a periodic box in the index space of a lattice.
#pragma once

#include <optional>
#include <vector>

#include "vog/dense.h"
#include "vog/linear.h"

namespace vog::moments {

/// Shifts from a point to its images in the boxes around a periodic one, index space: its edges times {-1, 0, 1}^3 without
/// (0, 0, 0). Empty where there is no box.
/// period  world units
std::vector<Vec3d> image_shifts(const std::optional<Box>& period, const Affine& world_from_index);

/// Voxels of a periodic box whose faces lie between leaves of the lattice. None for any other.
std::optional<IndexBox> leaf_period(const std::optional<Box>& period,
                                    const Affine& world_from_index);

}  // namespace vog::moments
