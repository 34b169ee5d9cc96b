// field_hit.h: A field along a ray through one Gaussian: its mean and its mean square under the truncated
// kernel (docs/fields.md). Double precision: the squares of a field that hardly varies cancel in floats.
#pragma once

#include "render/device/gaussian_hit.h"
#include "render/device/vector.h"

namespace vog::device {

/// Integrals along a ray of the kernel of unit peak, and of its moments about the nearest point.
struct SegmentMoments {
    double nearest;                ///< t of the smallest whitened distance, t*
    double zeroth, first, second;  ///< of 1, t - t*, (t - t*)²; all 0: the support is not met
};

/// Part of a ray that counts, t.
struct RayPart {
    double first = 0, last = HUGE_VAL;
};

/// Moments of exp(-½|t d - e|²) over the t of `part` with |t d - e| <= k.
/// e  whitened vector from the ray's origin to the mean;  d  whitened direction, any length > 0
VOG_HD SegmentMoments segment_moments(Double3 e, Double3 d, double cutoff2, RayPart part = {}) {
    const double root_half = 0.70710678118654752440, root_pi_half = 1.25331413731550025121;
    const double c = dot(d, d), root = sqrt(c);
    const Double3 offset = cross(e, d);
    const double m2 = dot(offset, offset) / c;
    SegmentMoments s{dot(e, d) / c, 0, 0, 0};
    if (!(m2 < cutoff2)) return s;
    // Ends of the chord in standard deviations from the nearest point.
    const double reach = sqrt(cutoff2 - m2);
    const double first = fmax(-reach, (part.first - s.nearest) * root);
    const double last = fmin(reach, (part.last - s.nearest) * root);
    if (!(first < last)) return s;
    const double peak = exp(-0.5 * m2) / root;
    const double at_first = exp(-0.5 * first * first), at_last = exp(-0.5 * last * last);
    const double whole = root_pi_half * (erf(root_half * last) - erf(root_half * first));
    s.zeroth = peak * whole;
    s.first = peak * (at_first - at_last) / root;
    s.second = peak * (whole + first * at_first - last * at_last) / c;
    return s;
}

/// A ray in a ray tracer's Gaussian.
struct FieldHit {
    SegmentMoments moments;
    Double3 from_mean;  ///< to the point at t*
};
VOG_HD FieldHit field_hit(const Gaussian& g, const Ray& ray, float cutoff2, RayPart part) {
    const Double3 to_mean = to_double(g.mean) - ray.origin;
    const Double3 w[3] = {to_double(g.w[0]), to_double(g.w[1]), to_double(g.w[2])};
    const Double3 e{dot(w[0], to_mean), dot(w[1], to_mean), dot(w[2], to_mean)};
    const Double3 d{dot(w[0], ray.direction), dot(w[1], ray.direction), dot(w[2], ray.direction)};
    const SegmentMoments moments = segment_moments(e, d, static_cast<double>(cutoff2), part);
    return {moments, moments.nearest * ray.direction - to_mean};
}

/// value + gradient · (x - mean), and a residual.
struct FieldPlane {
    double value;
    Double3 gradient;
    double variance;  ///< of the residual
};

/// FieldPlane of one Gaussian as a ray tracer stores it.
struct ScalarPlane {
    float value;
    Float3 gradient;
    float variance;
};
/// The same of a vector field, components along the world's axes.
struct VectorPlane {
    Float3 value;
    Float3 gradient[3];   ///< of each component
    float covariance[6];  ///< of the residual: xx xy xz yy yz zz
};
/// dᵀ R d
VOG_HD double variance_along(const float* r, Double3 d) {
    return d.x * (r[0] * d.x + 2 * (r[1] * d.y + r[2] * d.z)) +
           d.y * (r[3] * d.y + 2 * r[4] * d.z) + d.z * r[5] * d.z;
}
VOG_HD FieldPlane plane_along(const ScalarPlane& f, Double3) {
    return {static_cast<double>(f.value), to_double(f.gradient), static_cast<double>(f.variance)};
}
/// The component along `direction`, times its length.
VOG_HD FieldPlane plane_along(const VectorPlane& f, Double3 direction) {
    return {dot(to_double(f.value), direction),
            direction.x * to_double(f.gradient[0]) + direction.y * to_double(f.gradient[1]) +
                direction.z * to_double(f.gradient[2]),
            variance_along(f.covariance, direction)};
}

/// Mean of a field and of its square along a chord, weighted by the kernel.
struct FieldMean {
    double first, second;
};
/// from_mean  vector from the Gaussian's mean to the point at t*
/// s          moments along `direction`, s.zeroth > 0
VOG_HD FieldMean mean_along(const FieldPlane& f, Double3 from_mean, Double3 direction,
                            const SegmentMoments& s) {
    const double nearest = f.value + dot(f.gradient, from_mean);
    const double slope = dot(f.gradient, direction);
    const double shift = slope * (s.first / s.zeroth);
    return {nearest + shift, nearest * nearest + 2 * nearest * shift +
                                 slope * slope * (s.second / s.zeroth) + f.variance};
}

}  // namespace vog::device
