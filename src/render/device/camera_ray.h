// camera_ray.h: Ray generation: the ray of a pixel, clipped to the model's bounds.
//
// Scene units: the world divided by a power of two, so that the bounds have a radius in (1/2, 1]
// and no float overflows for any world unit. Camera and rays are in double precision: a ray
// is made once and intersected thousands of times.
#pragma once

#include "render/device/float_pair.h"
#include "render/device/vector.h"

namespace vog::device {

/// CameraFrame (vog/camera.h) in scene units.
struct Camera {
    Double3 eye, shift_x, shift_y;   ///< origin of pixel (column, row): eye + ...
    Double3 corner, step_x, step_y;  ///< direction of pixel (column, row): corner + ...
    int32_t width, height;
    int32_t orthographic;  ///< 1: parallel rays, no steps of the direction
};

struct Bounds {
    Double3 lower, upper;
};

/// origin + t direction, t in [0, length]: the part of a camera ray inside the bounds. All supports
/// lie inside, so clipping loses nothing; it keeps t small, however far away the eye.
struct Ray {
    Double3 origin;
    Double3 direction;  ///< unit length
    Double3 inverse;    ///< 1 / direction; a zero component counts as 1e-300
    float length;
    double end;          ///< t behind which nothing counts; infinite without a clip
    Exact3 from, along;  ///< origin and direction
};

VOG_HD double slab_inverse(double component) {
    const double tiny = 1e-300;  // decides rightly for every face but one that holds the origin
    return 1 / (fabs(component) < tiny ? copysign(tiny, component) : component);
}

/// Sets the ray but for its length.
/// direction  unit length
VOG_HD void set_ray(Double3 origin, Double3 direction, Ray& ray) {
    ray.origin = origin;
    ray.direction = direction;
    ray.end = HUGE_VAL;
    ray.inverse = {slab_inverse(direction.x), slab_inverse(direction.y), slab_inverse(direction.z)};
    ray.from = exact(origin);
    ray.along = exact(direction);
}

/// Narrows [enter, leave] to the part of the ray t / inverse in a box; empty if enter > leave.
/// to_lower, to_upper  corners of the box relative to the ray's origin
VOG_HD void clip_to_box(Double3 to_lower, Double3 to_upper, Double3 inverse, double& enter,
                        double& leave) {
    const double ax = to_lower.x * inverse.x, bx = to_upper.x * inverse.x;
    const double ay = to_lower.y * inverse.y, by = to_upper.y * inverse.y;
    const double az = to_lower.z * inverse.z, bz = to_upper.z * inverse.z;
    enter = fmax(enter, fmax(fmin(ax, bx), fmax(fmin(ay, by), fmin(az, bz))));
    leave = fmin(leave, fmin(fmax(ax, bx), fmin(fmax(ay, by), fmax(az, bz))));
}

/// The ray through a point of the image; whole numbers are centres of pixels.
/// returns  true if the ray meets the bounds in front of the eye
VOG_HD bool camera_ray(const Camera& camera, const Bounds& bounds, double column, double row,
                       Ray& ray) {
    const Double3 along = camera.corner + column * camera.step_x + row * camera.step_y;
    const Double3 from = camera.eye + column * camera.shift_x + row * camera.shift_y;
    const Double3 direction = (1 / sqrt(dot(along, along))) * along;
    const Double3 inverse{slab_inverse(direction.x), slab_inverse(direction.y),
                          slab_inverse(direction.z)};
    double enter = 0, leave = HUGE_VAL;
    clip_to_box(bounds.lower - from, bounds.upper - from, inverse, enter, leave);
    set_ray(from + enter * direction, direction, ray);
    ray.length = static_cast<float>(leave - enter);
    return enter <= leave;
}

}  // namespace vog::device
