// moment_error.h: the measured error of a model: relative L2 of T over views around the volume.
#pragma once

#include <span>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/volume.h"

namespace vog {

/// The data's own T from eight sides.
class ErrorViews {
  public:
    /// By exact traversal of the voxels.
    /// parts  add up
    ErrorViews(std::span<const Volume> parts, const Box& box);
    /// By the finest model that there is.
    explicit ErrorViews(const Gaussians& finest);
    /// sqrt(sum |T - T_ref|^2 / sum |T_ref|^2), over all pixels of all views
    double measure(const Gaussians& model) const;

  private:
    std::vector<Camera> cameras_;
    std::vector<DepthImage> reference_;
};

}  // namespace vog
