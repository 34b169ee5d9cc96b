// clip.cpp: the part of a ray inside a box and before planes.
#include "vog/clip.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "render/device/half_space.h"
#include "vog/error.h"

namespace vog {

void validate(const Clipping& clip) {
    if (clip.box) {
        const Box& box = *clip.box;
        if (!finite(box.lower) || !finite(box.upper))
            throw Error("clip box: expected finite corners");
        for (int axis = 0; axis < 3; ++axis)
            if (!(box.lower[axis] < box.upper[axis]))
                throw Error(
                    fmt::format("clip box: {} from {} to {}, expected the first below the second",
                                "xyz"[axis], box.lower[axis], box.upper[axis]));
    }
    for (const ClipPlane& plane : clip.planes)
        if (!finite(plane.normal) || !std::isfinite(plane.offset) || !(length(plane.normal) > 0))
            throw Error(fmt::format(
                "clip plane {},{},{},{}: expected finite numbers and a normal that is not 0",
                plane.normal.x, plane.normal.y, plane.normal.z, plane.offset));
}

Clipping relative_to(Clipping clip, Vec3d origin) {
    if (clip.box) clip.box = Box{clip.box->lower - origin, clip.box->upper - origin};
    for (ClipPlane& plane : clip.planes) plane.offset -= dot(plane.normal, origin);
    return clip;
}

RayInterval clipped_ray(const Clipping& clip, Vec3d origin, Vec3d direction) {
    device::RayPart part;
    if (clip.box)
        for (int axis = 0; axis < 3; ++axis) {
            device::cut(part, direction[axis], clip.box->lower[axis] - origin[axis]);
            device::cut(part, -direction[axis], origin[axis] - clip.box->upper[axis]);
        }
    for (const ClipPlane& plane : clip.planes)
        device::cut(part, dot(plane.normal, direction), plane.offset - dot(plane.normal, origin));
    return {part.first, part.last};
}

}  // namespace vog
