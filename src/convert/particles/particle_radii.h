// particle_radii.h: standard deviations of particles' Gaussians, from neighbours or from stated kernels.
#pragma once

#include <optional>

#include "data/point_grid.h"
#include "vog/convert_points.h"

namespace vog::particles {

/// Half the distance to the k-th neighbour, world units [N]. The support of such a Gaussian holds about as many neighbours as a
/// kernel of smoothed-particle hydrodynamics.
/// period  box across whose faces neighbours are found, with all positions in it; none: open
/// throws  vog::Error where all particles lie in one place
BigVector<double> adaptive_radii(const Points& points, const PointGrid& grid,
                                 const PointOptions& options, const std::optional<Box>& period);

/// Standard deviations of cubic splines that end at the radii of an attribute, world units [N]; lengths in another unit than the
/// positions are converted.
/// throws  vog::Error for a radius that is not above 0, or in a unit that is no length
BigVector<double> smoothing_radii(const Points& points, const SmoothingRadius& smoothing);

}  // namespace vog::particles
