// vog/clip.h: Clipping of pictures: a box and planes in the world, exact on each ray.
#pragma once

#include <optional>
#include <vector>

#include "vog/linear.h"

namespace vog {

/// Plane that cuts off its side behind: a point x stays where dot(normal, x) >= offset.
struct ClipPlane {
    Vec3d normal;       ///< any length > 0
    double offset = 0;  ///< in world units times the normal's length
    friend bool operator==(const ClipPlane&, const ClipPlane&) = default;
};

/// Space that a picture shows; the default is all of it.
struct Clipping {
    std::optional<Box> box;  ///< world units; nothing: no box
    std::vector<ClipPlane> planes;

    bool empty() const { return !box && planes.empty(); }
    friend bool operator==(const Clipping&, const Clipping&) = default;
};

/// throws  vog::Error for a box that is inside out or empty, a normal of length 0, and numbers that are not finite
void validate(const Clipping& clip);

/// The same space in coordinates relative to a point.
Clipping relative_to(Clipping clip, Vec3d origin);

/// Interval of a ray.
struct RayInterval {
    double first = 0, last = 0;  ///< t; empty where first >= last
};
/// Part of the ray origin + t direction, t >= 0, that stays.
/// direction  of any length > 0
RayInterval clipped_ray(const Clipping& clip, Vec3d origin, Vec3d direction);

}  // namespace vog
