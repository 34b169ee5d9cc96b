// chord.h: Chords of rays through Gaussians, their parts between any two ends, and sums of a field over them, in single
// precision (docs/fields.md, "Mathematics of the projection"). Shared by CUDA's splat and OptiX's any-hit programs.
//
// u counts standard deviations along the ray from the nearest point; the integral of the kernel over a part is a difference
// of G(u) = integral of e^{-s²/2} from 0 to u.
#pragma once

#include "render/device/half_space.h"
#include "render/device/tile_splat.h"

namespace vog::device {

/// RayPart as pairs of floats, t.
struct PartEnds {
    float first, first_low, last, last_low;
};
VOG_HD PartEnds ends_of(RayPart part) {
    const float first = static_cast<float>(part.first), last = static_cast<float>(part.last);
    const bool open = part.last == HUGE_VAL;
    return {first, static_cast<float>(part.first - static_cast<double>(first)), last,
            open ? 0.0f : static_cast<float>(part.last - static_cast<double>(last))};
}

/// The view of a picture of chords, scene units.
struct ChordView {
    Double3 forward;          ///< unit length
    double depth;             ///< along the view from the eye, subtracted from all depths
    const HalfSpace* planes;  ///< [plane_count] of the clip
    int32_t plane_count;
};

/// The ray of a pixel, with what the clip leaves of it.
struct ChordRay {
    Ray ray;
    int32_t meets;  ///< 0: misses the model's bounds
    PartEnds ends;  ///< in front of the eye, which may lie behind the ray's origin
    float slant;    ///< length of ray a unit of depth
    float depth;    ///< of the ray's origin
};
/// column, row  whole numbers are centres of pixels
VOG_HD ChordRay chord_ray(const Camera& camera, const Bounds& bounds, const ChordView& view,
                          double column, double row) {
    ChordRay out;
    out.meets = camera_ray(camera, bounds, column, row, out.ray) ? 1 : 0;
    const Double3 eye = camera.eye + column * camera.shift_x + row * camera.shift_y;
    const Double3 origin = out.ray.origin, direction = out.ray.direction;
    RayPart part{dot(eye - origin, direction), HUGE_VAL};
    for (int32_t n = 0; n < view.plane_count; ++n) cut(part, view.planes[n], origin, direction);
    out.ends = ends_of(part);
    out.slant = static_cast<float>(1 / dot(direction, view.forward));
    out.depth = static_cast<float>(dot(origin - camera.eye, view.forward) - view.depth);
    return out;
}

/// The part of a ray inside a support.
struct Chord {
    float tau;                 ///< optical depth of a part over its G(u1) - G(u0)
    float nearest, deviation;  ///< t of u = 0 and of a unit of u
    float first, last;         ///< u
    Float3 from_mean;          ///< to the nearest point
};

/// Integral of e^{-s²/2} from 0 to u.
VOG_HD float normal_integral(float u) {
    const float root_half = 0.707106781186547524f, root_pi_half = 1.25331413731550025f;
    return root_pi_half * erff(root_half * u);
}

/// Ends of a chord.
/// reach  u of the support's ends
/// rest   t of the nearest point less `nearest`
/// returns  false if nothing is left
VOG_HD bool set_ends(const PartEnds& ends, float nearest, float rest, float deviation, float reach,
                     Chord& out) {
    out.first = fmaxf(-reach, (((ends.first - nearest) + ends.first_low) - rest) / deviation);
    out.last = fminf(reach, (((ends.last - nearest) + ends.last_low) - rest) / deviation);
    return out.first < out.last;
}

/// The chord of a ray tracer's hit.
/// share  of the Gaussian's tau that counts
VOG_HD bool chord_of(const Gaussian& g, const Ray& ray, const Hit& hit, const PartEnds& ends,
                     float share, Chord& out) {
    const Float3 d = whiten(g, rounded(ray.along));
    const float per_unit = 1 / fmaxf(fabsf(d.x), fmaxf(fabsf(d.y), fabsf(d.z)));
    const Float3 u = per_unit * d;
    const float per_c = 1 / dot(u, u);
    const Float3 to_mean = less_multiple(difference(g.mean, ray.from), hit.nearest, ray.along);
    const float rest = dot(whiten(g, to_mean), u) * per_c * per_unit;
    out.nearest = hit.nearest;
    out.deviation = sqrtf(per_c) * per_unit;
    out.from_mean = rest * rounded(ray.along) - to_mean;
    out.tau = share * g.density * out.deviation * expf(-0.5f * hit.m2);
    return set_ends(ends, hit.nearest, rest, out.deviation, hit.half / out.deviation, out);
}

/// Depths of a projected Gaussian, along the view, scene units.
struct SplatDepth {
    float depth;             ///< of the mean, from ChordView::depth
    float forward;           ///< of the mean, from the eye; parallel rays: 0
    float deviation;         ///< along the view, times sqrt(C) of TileSplat
    float depth_x, depth_y;  ///< parallel rays: change of the nearest point's depth a pixel
    float near, far;         ///< range of the whole support in front of the eye
};
/// g  as it is, not widened
VOG_HD SplatDepth splat_depth(const SplatSource& g, const Camera& camera, const ChordView& view,
                              double cutoff, const TileSplat& splat) {
    const Double3 spread = apply(g.axes.a, view.forward);
    const double z = dot(g.mean - camera.eye, view.forward);
    const double deviation = sqrt(dot(spread, spread)), reach = cutoff * deviation;
    SplatDepth out;
    out.depth = static_cast<float>(z - view.depth);
    out.near = static_cast<float>(fmax(z - reach, 0.0) - view.depth);
    out.far = static_cast<float>(fmax(z + reach, 0.0) - view.depth);
    if (!camera.orthographic) {
        // 1 / |W D| is at most the deviation along the view, where C is e02.
        out.forward = static_cast<float>(z);
        out.deviation = sqrtf(splat.e02) * static_cast<float>(deviation);
        out.depth_x = out.depth_y = 0;
        return out;
    }
    // Wᵀ W f is the normal of the plane of nearest points; C is 1.
    const Double3 whitened = apply(g.axes.w, view.forward);
    const double variance = 1 / dot(whitened, whitened);
    out.forward = 0;
    out.deviation = static_cast<float>(sqrt(variance));
    out.depth_x = static_cast<float>(-variance * dot(whitened, apply(g.axes.w, camera.shift_x)));
    out.depth_y = static_cast<float>(-variance * dot(whitened, apply(g.axes.w, camera.shift_y)));
    return out;
}

/// The chord of a Gaussian that is drawn wider than it is.
VOG_HD bool widened_chord(const TileSplat& s, const SplatDepth& at, const Kernel& kernel,
                          const ChordRay& ray, int32_t column, int32_t row, Chord& out) {
    const float drawn = far_depth(s, kernel, column, row);
    if (!(drawn > 0)) return false;
    const float x = static_cast<float>(column - s.column) - s.offset_x;
    const float y = static_cast<float>(row - s.row) - s.offset_y;
    const float delta_c = s.cx * x + s.cy * y, delta_d = s.dy * y;
    const float c = s.c0 + delta_c, d = s.d0 + delta_d, a = s.ax * x + s.ay * y;
    const float per_c = 1 / (c * c + d * d + s.e02);
    const float reach = sqrtf(fmaxf(kernel.cutoff2 - (a * a + s.by2 * y * y) * per_c, 0.0f));
    const float depth = at.depth + at.depth_x * x + at.depth_y * y -
                        at.forward * (delta_c * c + delta_d * d) * per_c;
    out.nearest = (depth - ray.depth) * ray.slant;
    out.deviation = at.deviation * sqrtf(per_c) * ray.slant;
    out.from_mean = {0, 0, 0};
    out.tau = drawn * ray.slant / (2 * normal_integral(reach));
    return set_ends(ray.ends, out.nearest, 0, out.deviation, reach, out);
}

/// Planes around the rays of a tile in single precision, normals of unit length.
struct TilePlanes {
    Float3 normal[4];  ///< inwards
    float offset[4];
};
/// One of the four.
VOG_HD void set_plane(const Frustum& frustum, int n, TilePlanes& planes) {
    const Double3 normal = frustum.normal[n];
    const Double3 unit = (1 / sqrt(dot(normal, normal))) * normal;
    planes.normal[n] = to_float(unit);
    planes.offset[n] = static_cast<float>(dot(unit, frustum.point[n]));
}
/// False only if the support lies outside one of the planes. may_meet() with a margin for single precision, at a fifth
/// of its registers.
VOG_HD bool may_reach(const Gaussian& g, const TilePlanes& planes, float cutoff2) {
    for (int n = 0; n < 4; ++n) {
        float reach2 = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const float along = dot(g.w[axis], planes.normal[n]) / dot(g.w[axis], g.w[axis]);
            reach2 += along * along;
        }
        const float at = dot(planes.normal[n], g.mean) - planes.offset[n];
        // Rounding of positions, and of the whitening, whose rows are at right angles within 1e-7.
        const float margin =
            4e-6f * (fabsf(g.mean.x) + fabsf(g.mean.y) + fabsf(g.mean.z) + fabsf(planes.offset[n]));
        if (at < -margin - 1.001f * sqrtf(cutoff2 * reach2)) return false;
    }
    return true;
}

/// Sums over chords: tau, and tau times the means of a field and of its square.
struct ChordSums {
    float tau, first, second;
};

VOG_HD ScalarPlane along(const ScalarPlane& f, Float3) { return f; }
/// The component along a unit vector.
VOG_HD ScalarPlane along(const VectorPlane& f, Float3 d) {
    const float* r = f.covariance;
    return {dot(f.value, d), d.x * f.gradient[0] + d.y * f.gradient[1] + d.z * f.gradient[2],
            d.x * (r[0] * d.x + 2 * (r[1] * d.y + r[2] * d.z)) +
                d.y * (r[3] * d.y + 2 * r[4] * d.z) + d.z * r[5] * d.z};
}
/// A field inside a Gaussian drawn wider than it is: constant, with its whole variance.
/// within  SplatKernel::variance
VOG_HD ScalarPlane constant(const ScalarPlane& f, const Gaussian& g, float within) {
    float spread2 = 0;
    for (int n = 0; n < 3; ++n) {
        const float across = dot(g.w[n], f.gradient) / dot(g.w[n], g.w[n]);
        spread2 += across * across;
    }
    return {f.value, {0, 0, 0}, f.variance + within * spread2};
}

VOG_HD ChordSums sums_over(const Chord& chord, const ScalarPlane& f, Float3 direction) {
    const float at_first = expf(-0.5f * chord.first * chord.first);
    const float at_last = expf(-0.5f * chord.last * chord.last);
    const float whole = normal_integral(chord.last) - normal_integral(chord.first);
    const float shift = at_first - at_last;
    const float square = whole + chord.first * at_first - chord.last * at_last;
    const float value = f.value + dot(f.gradient, chord.from_mean);
    const float slope = dot(f.gradient, direction) * chord.deviation;
    return {chord.tau * whole, chord.tau * (value * whole + slope * shift),
            chord.tau * ((value * value + f.variance) * whole + 2 * value * slope * shift +
                         slope * slope * square)};
}

/// Column, mean and deviation of a pixel; NaN without a column.
/// unit  of the column
VOG_HD void finish_sums(double tau, double first, double second, double unit, float* column,
                        float* mean, float* deviation) {
    *column = static_cast<float>(tau * unit);
    *mean = *deviation = NAN;
    if (!(*column > 0)) return;
    const double middle = first / tau;
    *mean = static_cast<float>(middle);
    *deviation = static_cast<float>(sqrt(fmax(second / tau - middle * middle, 0.0)));
}

}  // namespace vog::device
