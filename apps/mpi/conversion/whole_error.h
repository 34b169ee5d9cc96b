// whole_error.h: the measured error of a model that is spread over all ranks.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "ranks.h"
#include "vog/camera.h"
#include "vog/convert_moments.h"
#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::mpi {

/// Relative L2 of T of the whole model against the whole volume, over error_views
/// (vog/distributed.h).
class WholeError {
  public:
    /// volumes  of this rank; their T add up
    /// box      of the whole data, world space: frames the views
    WholeError(std::span<const Volume> volumes, const Box& box, const Ranks& ranks);
    /// models   of this rank
    /// returns  worst and mean error of the views, the same on every rank
    /// throws   vog::Error, on every rank, if no view shows anything
    std::pair<double, double> of(const std::vector<Gaussians>& models) const;

  private:
    const Ranks& ranks_;
    std::vector<Camera> cameras_;
    std::vector<DepthImage> references_;  ///< on the first rank: T of the whole volume
};

}  // namespace vog::mpi
