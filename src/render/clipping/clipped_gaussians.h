// clipped_gaussians.h: supports of Gaussians and the space that a clip leaves.
#pragma once

#include <vector>

#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/gaussians.h"

namespace vog::clipping {

/// Part of a support that a clip leaves.
enum class Kept { all, part, none };

/// Box around the supports, relative to Gaussians::origin: around the sphere of each.
/// cutoff  k
Box support_box(const Gaussians& gaussians, double cutoff);
/// Planes of a clip that cut off some of a box, and the clip's box if that does: of a box inside nothing.
Clipping cutting(Clipping clip, const Box& box);

/// Share of a Gaussian's integral along the ray through its mean that a clip leaves: what counts of a Gaussian that is
/// drawn as a point.
/// clip, frame  relative to the same point as the mean, which lies in front of the eye
/// cutoff       k
double share_at_mean(const Clipping& clip, Vec3d mean, const Mat3& whitening, double cutoff,
                     const CameraFrame& frame);

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
    /// clipping::share_at_mean of Gaussian i.
    /// frame  relative to Gaussians::origin
    double share_at_mean(std::size_t i, const CameraFrame& frame) const;

  private:
    Clipping clip_;
    std::vector<ClipPlane> planes_;  ///< the box's, too; normals of length 1
    const Gaussians& gaussians_;
    double cutoff_;
};

}  // namespace vog::clipping
