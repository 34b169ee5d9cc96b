// clipped_gaussians.h: supports of Gaussians and the space that a clip leaves.
#pragma once

#include <vector>

#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/gaussians.h"

namespace vog::clipping {

/// Part of a support that a clip leaves.
enum class Kept { all, part, none };

/// A clip of a model's Gaussians, in coordinates relative to Gaussians::origin.
class GaussianClip {
  public:
    /// clip    in world coordinates; an empty one leaves everything
    /// cutoff  k of the kernels
    /// throws  vog::Error as validate(Clipping) does
    GaussianClip(const Clipping& clip, const Gaussians& gaussians, double cutoff);

    bool empty() const { return clip_.empty(); }
    /// Decided plane by plane: `part` for some supports outside of a corner of the box.
    Kept of(std::size_t i) const;
    /// Part of a ray, in units of its direction.
    RayInterval ray(Vec3d origin, Vec3d direction) const {
        return clipped_ray(clip_, origin, direction);
    }
    /// Share of the integral along the ray through the mean that stays: what counts of a Gaussian that is
    /// drawn as a point.
    /// frame  relative to Gaussians::origin; the mean lies in front of the eye
    double share_at_mean(std::size_t i, const CameraFrame& frame) const;

  private:
    Clipping clip_;
    std::vector<ClipPlane> planes_;  ///< the box's, too
    const Gaussians& gaussians_;
    double cutoff_;
};

}  // namespace vog::clipping
