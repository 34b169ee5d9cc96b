// half_space.h: Clips of rays by planes, for the CPU's and the GPU's renderers.
#pragma once

#include "render/device/field_hit.h"

namespace vog::device {

/// The side of a plane that a clip leaves: dot(normal, x) >= offset.
struct HalfSpace {
    Double3 normal;  ///< of any length > 0
    double offset;
};

/// Cuts an interval to where ahead * t >= start; parallel rays are inside or not.
VOG_HD void cut(RayPart& part, double ahead, double start) {
    if (ahead == 0) {
        if (start > 0) part.last = part.first;
    } else if (ahead > 0) {
        part.first = fmax(part.first, start / ahead);
    } else {
        part.last = fmin(part.last, start / ahead);
    }
}
VOG_HD void cut(RayPart& part, const HalfSpace& by, Double3 origin, Double3 direction) {
    cut(part, dot(by.normal, direction), by.offset - dot(by.normal, origin));
}

}  // namespace vog::device
