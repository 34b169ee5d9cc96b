// whole_error.h: the measured error of a model that is spread over all ranks.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "ranks.h"
#include "vog/camera.h"
#include "vog/distributed.h"
#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::mpi {

/// Relative L2 of T of the whole model against the whole volume, over error_views
/// (vog/distributed.h).
class WholeError {
  public:
    /// volumes  of this rank; their T add up
    /// box      of the whole data, world space: frames the views
    /// period   periodic box: models are drawn with their images, inside the box; none: open
    WholeError(std::vector<Volume> volumes, const Box& box, const std::optional<Box>& period,
               const Ranks& ranks);
    /// models   of this rank
    /// returns  the same on every rank
    /// throws   vog::Error, on every rank, if no view shows anything
    RelativeError of(const std::vector<Gaussians>& models) const;
    /// Error of the same voxels, interpolated linearly, in place of a model.
    const RelativeError& interpolation() const { return interpolation_; }

  private:
    /// picture_of  T of this rank from a camera
    RelativeError of(const std::function<DepthImage(const Camera&)>& picture_of) const;

    const Ranks& ranks_;
    std::optional<Box> period_;
    std::vector<Camera> cameras_;
    std::vector<DepthImage> references_;  ///< on the first rank: T of the whole volume
    RelativeError interpolation_;
};

}  // namespace vog::mpi
