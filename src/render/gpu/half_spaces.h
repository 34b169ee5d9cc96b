// half_spaces.h: A clip as planes of the GPU's rays.
#pragma once

#include <vector>

#include "render/device/half_space.h"
#include "render/shown_field.h"
#include "vog/clip.h"

namespace vog::gpu {

/// Planes of a clip.
/// unit  world units of one of the rays
inline std::vector<device::HalfSpace> half_spaces(const Clipping& clip, double unit) {
    std::vector<device::HalfSpace> all;
    for (const ClipPlane& plane : clip.planes)
        all.push_back({plain(plane.normal), plane.offset / unit});
    for (int axis = 0; clip.box && axis < 3; ++axis) {
        Vec3d normal;
        normal[axis] = 1;
        all.push_back({plain(normal), clip.box->lower[axis] / unit});
        all.push_back({plain(-normal), -clip.box->upper[axis] / unit});
    }
    return all;
}

}  // namespace vog::gpu
