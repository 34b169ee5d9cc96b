// gaussian_hit.h: Intersection of a ray with a truncated Gaussian: entry, exit and optical depth
// between them (docs/method.md, "One Gaussian along a ray").
//
// Single precision. The vector from the mean to the nearest point of the ray (in the Gaussian's own metric) is formed in
// pairs of floats (on a CPU in doubles) and only then whitened. In single floats this difference cancels: at a distance of 1000 standard
// deviations the error is 1e-4 of a standard deviation, and larger in tau. All later values are of the size of the
// Gaussian itself.
#pragma once

#include "render/device/camera_ray.h"
#include "render/device/vector.h"

namespace vog::device {

/// One Gaussian of the model, 64 bytes, in scene units. |W (x - mean)| is the distance from the
/// mean in standard deviations.
struct alignas(16) Gaussian {  // four loads of 16 bytes
    Float3 mean;
    float density;  ///< peak, units of depth (TraceModel::depth_unit) per scene unit
    Float3 w[3];    ///< rows of the whitening W
    Float3 half;    ///< half edges of the paper's bounding box; unused without boxes
};

static_assert(sizeof(Gaussian) == 64, "four loads");

/// Segment of a ray inside a support: the attributes that OptiX passes from __intersection__ to
/// __anyhit__.
struct Hit {
    float nearest;  ///< t of the smallest whitened distance
    float half;     ///< half the length of the chord through the support
    float m2;       ///< squared smallest whitened distance
    float width;    ///< length of sqrt(2) standard deviations along the ray

    VOG_HD float entry() const;
    VOG_HD float exit() const;
};

VOG_HD float Hit::entry() const { return fmaxf(nearest - half, 0.0f); }
VOG_HD float Hit::exit() const { return nearest + half; }

VOG_HD Float3 whiten(const Gaussian& g, Float3 v) {
    return {dot(g.w[0], v), dot(g.w[1], v), dot(g.w[2], v)};
}

/// Intersects a ray with the support |W (x - mean)|² < k²: the paper's quadratic, without its
/// discriminant, which cancels.
/// cutoff2  k²
/// returns  true if the ray meets the support at some t > 0
VOG_HD bool intersect(const Gaussian& g, const Ray& ray, float cutoff2, Hit& hit) {
    // d = W direction, scaled to a largest component of 1: no square of it over- or underflows.
    const Float3 d = whiten(g, rounded(ray.along));
    const float per_unit = 1 / fmaxf(fabsf(d.x), fmaxf(fabsf(d.y), fabsf(d.z)));
    const Float3 u = per_unit * d;
    const float per_c = 1 / dot(u, u);

    // The nearest point, to the precision of a float at this distance, ...
    const Exact3 to_mean = difference(g.mean, ray.from);
    const float guess = dot(whiten(g, rounded(to_mean)), u) * per_c * per_unit;
    // ... and its offset from the mean, to the precision of a float at the Gaussian's own size.
    const Float3 e = whiten(g, less_multiple(to_mean, guess, ray.along));
    const Float3 offset = cross(e, u);
    hit.m2 = dot(offset, offset) * per_c;
    if (!(hit.m2 < cutoff2)) return false;
    hit.nearest = guess + dot(e, u) * per_c * per_unit;
    hit.half = sqrtf((cutoff2 - hit.m2) * per_c) * per_unit;
    hit.width = sqrtf(2 * per_c) * per_unit;
    return hit.nearest + hit.half > 0;
}

/// Optical depth tau of the hit: density times the integral of the kernel over [entry, exit].
/// after  chord length behind the nearest point
VOG_HD float optical_depth(const Gaussian& g, const Hit& hit, float after) {
    const float sqrt_pi_half = 0.886226925452758f;      // sqrt(pi) / 2
    const float before = fminf(hit.half, hit.nearest);  // chord length before the nearest point
    return g.density * sqrt_pi_half * hit.width * expf(-0.5f * hit.m2) *
           (erff(after / hit.width) + erff(before / hit.width));
}
VOG_HD float optical_depth(const Gaussian& g, const Hit& hit) {
    return optical_depth(g, hit, hit.half);
}
/// The same of the part before the end of the ray; not above 0: nothing.
VOG_HD float clipped_depth(const Gaussian& g, const Hit& hit, const Ray& ray) {
    return optical_depth(g, hit, fminf(hit.half, static_cast<float>(ray.end) - hit.nearest));
}

/// True if the ray meets the paper's bounding box of the Gaussian, mean - half to mean + half,
/// clamped to the scene's box. A hierarchy's own boxes are wider and may be shared by several
/// primitives, so where the box decides what is visible it is tested here.
VOG_HD bool meets_box(const Gaussian& g, const Ray& ray, const Bounds& scene) {
    const Double3 mean = to_double(g.mean), half = to_double(g.half);
    Double3 lower = mean - half, upper = mean + half;
    lower = {fmin(fmax(lower.x, scene.lower.x), scene.upper.x),
             fmin(fmax(lower.y, scene.lower.y), scene.upper.y),
             fmin(fmax(lower.z, scene.lower.z), scene.upper.z)};
    upper = {fmin(fmax(upper.x, scene.lower.x), scene.upper.x),
             fmin(fmax(upper.y, scene.lower.y), scene.upper.y),
             fmin(fmax(upper.z, scene.lower.z), scene.upper.z)};
    double enter = 0, leave = ray.end;
    clip_to_box(lower - ray.origin, upper - ray.origin, ray.inverse, enter, leave);
    return enter <= leave;
}

}  // namespace vog::device
