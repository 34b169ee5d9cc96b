// slice_points.h: Points where the rays of a picture meet a plane, and the pixels of points.
#pragma once

#include <cmath>
#include <optional>

#include "vog/camera.h"
#include "vog/clip.h"

namespace vog::slices {

/// Rays of a picture and a plane, relative to the same point.
class SlicePoints {
  public:
    SlicePoints(const CameraFrame& frame, const ClipPlane& plane, const Clipping& clip)
        : frame_(frame), plane_(plane), clip_(clip) {}

    const CameraFrame& frame() const { return frame_; }
    /// Point of a ray on the plane, in front of the eye and inside the clip.
    std::optional<Vec3d> at(double column, double row) const {
        const Vec3d origin = frame_.origin(column, row), direction = frame_.direction(column, row);
        const double slope = dot(plane_.normal, direction);
        const double t = (plane_.offset - dot(plane_.normal, origin)) / slope;
        if (slope == 0 || !(t >= 0)) return {};
        const Vec3d point = origin + t * direction;
        if (clip_.empty()) return point;
        const RayInterval kept = clipped_ray(clip_, origin, direction);
        if (!(kept.first <= t && t <= kept.last)) return {};
        return point;
    }

    /// Pixel of a point.
    struct Pixel {
        double column, row;
    };
    /// returns  nothing for points that are not in front of a pinhole camera
    std::optional<Pixel> pixel_of(Vec3d point) const {
        const CameraFrame& f = frame_;
        if (f.orthographic) {
            const Vec3d from = point - f.first_origin;
            return Pixel{dot(from, f.right) / dot(f.shift_x, f.right),
                         dot(from, f.up) / dot(f.shift_y, f.up)};
        }
        const Vec3d from = point - f.eye;
        const double depth = dot(from, f.forward);
        if (!(depth > 0)) return {};
        return Pixel{(dot(from, f.right) / depth - dot(f.corner, f.right)) / dot(f.step_x, f.right),
                     (dot(from, f.up) / depth - dot(f.corner, f.up)) / dot(f.step_y, f.up)};
    }

  private:
    const CameraFrame& frame_;
    const ClipPlane& plane_;
    const Clipping& clip_;
};

}  // namespace vog::slices
