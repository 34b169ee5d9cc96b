// tile_splat.h: Splatting on a GPU (docs/method.md, "Splatting without approximation").
// A Gaussian is projected once in double precision; a pixel then costs two quadratics, a square root
// and a polynomial in single precision.
#pragma once

#include "render/device/camera_ray.h"
#include "render/device/gaussian_hit.h"
#include "render/device/pixel_limits.h"
#include "render/device/vector.h"

namespace vog::device {

/// One Gaussian of the model, in scene units.
struct SplatGaussian {
    Float3 mean, scale;
    float rotation[4];  ///< w x y z
    float density;
};

/// KernelPolynomial (kernel_polynomial.h): sqrt(pi) e^{-k²/2} P(u) in powers of slope 2u + shift,
/// 2u = k² - m².
struct Kernel {
    float coefficient[41];
    int32_t degree;
    float slope, shift;
    float cutoff2;
};

/// Cutoff and kernel of a model, and the limits of pixel_limits.h in terms of its scales.
struct SplatKernel {
    Kernel kernel;
    double cutoff;
    double least2;    ///< smallest variance drawn, pixels²; 0: Gaussians of any size are sampled
    double sampled2;  ///< variance from which pixel centres are exact, pixels²
    double variance;  ///< variance of the truncated kernel over scale²
    double mass;      ///< of a Gaussian of peak 1 and standard deviations 1
};

/// Rectangle of pixels or tiles.
struct PixelRange {
    int32_t x0, x1, y0, y1;  ///< inclusive
    VOG_HD bool empty() const { return x1 < x0 || y1 < y0; }
};

/// With (x, y) the pixel's offset from the projected mean, and lengths in units of the whitened
/// direction there:
///   m² C = (ax x + ay y)² + by2 y²        C = (c0 + cx x + cy y)² + (d0 + dy y)² + e02
/// Parallel rays: C = 1.
/// Sums of squares, by triangular bases: nothing cancels, however elongated or far the Gaussian.
struct TileSplat {
    PixelRange pixels;
    int32_t column, row;       ///< pixel nearest the projected mean
    float offset_x, offset_y;  ///< from that pixel to the projected mean
    float ax, ay, by2;
    float c0, cx, cy, d0, dy, e02;
    float weight;
    int32_t near;     ///< 1: reaches the plane of the eye, integrated exactly at each pixel
    int32_t widened;  ///< 1: thinner than kLeastDeviationPx, and drawn wider
    float share;      ///< of the Gaussian's own tau that is drawn, for those not widened
};

/// Whitening W = diag(1/s) Rᵀ by rows, and A = diag(s) Rᵀ = W⁻ᵀ.
struct Axes {
    Double3 w[3], a[3];
};
VOG_HD Axes axes_of(const SplatGaussian& g) {
    double w = g.rotation[0], x = g.rotation[1], y = g.rotation[2], z = g.rotation[3];
    const double s = 1 / sqrt(w * w + x * x + y * y + z * z);
    w *= s, x *= s, y *= s, z *= s;
    // Columns of the rotation: the Gaussian's own axes in the world.
    const Double3 axis[3] = {
        {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
        {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
        {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)},
    };
    const double scale[3] = {g.scale.x, g.scale.y, g.scale.z};
    Axes out;
    for (int n = 0; n < 3; ++n) {
        out.w[n] = (1 / scale[n]) * axis[n];
        out.a[n] = scale[n] * axis[n];
    }
    return out;
}
VOG_HD Double3 apply(const Double3 m[3], Double3 v) {
    return {dot(m[0], v), dot(m[1], v), dot(m[2], v)};
}
/// Of a ray tracer's Gaussian.
VOG_HD Axes axes_of(const Gaussian& g) {
    Axes out;
    for (int n = 0; n < 3; ++n) {
        out.w[n] = to_double(g.w[n]);
        out.a[n] = (1 / dot(out.w[n], out.w[n])) * out.w[n];
    }
    return out;
}

/// A Gaussian as it is projected, scene units.
struct SplatSource {
    Double3 mean;
    Axes axes;
    double density;
};
VOG_HD SplatSource source_of(const SplatGaussian& g) {
    return {to_double(g.mean), axes_of(g), static_cast<double>(g.density)};
}
VOG_HD SplatSource source_of(const Gaussian& g) {
    return {to_double(g.mean), axes_of(g), static_cast<double>(g.density)};
}

/// The Gaussian in the form of intersect(), for near splats.
VOG_HD Gaussian whitened(const SplatGaussian& g) {
    const Axes axes = axes_of(g);
    Gaussian out;
    out.mean = g.mean;
    out.density = g.density;
    for (int n = 0; n < 3; ++n) out.w[n] = to_float(axes.w[n]);
    out.half = {0, 0, 0};
    return out;
}

/// Pixels whose centres lie between the roots of a x² + 2 b x + c, a > 0 >= c.
/// at  pixel coordinate of x = 0
VOG_HD void pixels_between(double a, double b, double c, double at, int32_t size, int32_t& first,
                           int32_t& last) {
    const double slack = 1e-3;  // pixels; the exact test follows at each pixel
    const double root = sqrt(fmax(b * b - a * c, 0.0));
    const double lower = at + (-b - root) / a - slack, upper = at + (-b + root) / a + slack;
    first = static_cast<int32_t>(ceil(fmin(fmax(lower, 0.0), size + 1.0)));
    last = static_cast<int32_t>(floor(fmin(fmax(upper, -2.0), size - 1.0)));
}

/// m² C = |x P + y Q|², by a basis along P.
VOG_HD void fill_distance(Double3 p, Double3 q, double q_across, TileSplat& out) {
    const double p_length = sqrt(dot(p, p));
    out.ax = static_cast<float>(p_length);
    out.ay = static_cast<float>(dot(p, q) / p_length);
    out.by2 = static_cast<float>(q_across * q_across);
}
/// x, y  the mean's pixel
VOG_HD void fill_place(double x, double y, TileSplat& out) {
    const double column = floor(x + 0.5), row = floor(y + 0.5);
    out.column = static_cast<int32_t>(column);
    out.row = static_cast<int32_t>(row);
    out.offset_x = static_cast<float>(x - column);
    out.offset_y = static_cast<float>(y - row);
}

/// Fills the quadratics of a Gaussian whose support lies in front of the eye plane.
/// v, z  vector from the eye to the mean, and its component along `forward`;  x, y  the mean's pixel
VOG_HD void fill_far(double density, const Axes& axes, const Camera& camera, Double3 v, double z,
                     double x, double y, TileSplat& out) {
    const Double3 center = apply(axes.w, (1 / z) * v);
    const double length = sqrt(dot(center, center));
    const Double3 c = (1 / length) * center;
    const Double3 u = (1 / length) * apply(axes.w, camera.step_x);
    const Double3 w = (1 / length) * apply(axes.w, camera.step_y);
    const double e = z * length;  // |W (mean - eye)|

    // P = c x u; the rest of Q = c x w has length |c · (u x w)| / |P|.
    const Double3 p = cross(c, u), q = cross(c, w);
    fill_distance(e * p, e * q, e * dot(c, cross(u, w)) / sqrt(dot(p, p)), out);

    // C: basis along u, then across it in the plane of u and w, then their normal.
    const double u_length = sqrt(dot(u, u));
    const Double3 first = (1 / u_length) * u;
    const Double3 normal = cross(u, w);
    const Double3 third = (1 / sqrt(dot(normal, normal))) * normal;
    const Double3 second = cross(third, first);
    const double across = dot(c, third);
    out.c0 = static_cast<float>(dot(c, first));
    out.cx = static_cast<float>(u_length);
    out.cy = static_cast<float>(dot(w, first));
    out.d0 = static_cast<float>(dot(c, second));
    out.dy = static_cast<float>(dot(w, second));
    out.e02 = static_cast<float>(across * across);
    out.weight = static_cast<float>(density / length);
    fill_place(x, y, out);
}

/// Fills the quadratics for parallel rays: the whitened distance from the mean grows by W shift_x and
/// W shift_y from pixel to pixel.
VOG_HD void fill_parallel(double density, const Axes& axes, const Camera& camera, double x,
                          double y, TileSplat& out) {
    const Double3 along = apply(axes.w, camera.corner);
    const double length = sqrt(dot(along, along));
    const Double3 c = (1 / length) * along;
    const Double3 u = apply(axes.w, camera.shift_x), w = apply(axes.w, camera.shift_y);
    const Double3 p = cross(c, u), q = cross(c, w);
    fill_distance(p, q, dot(c, cross(u, w)) / sqrt(dot(p, p)), out);
    out.c0 = out.cx = out.cy = out.d0 = out.dy = 0;
    out.e02 = 1;
    out.weight = static_cast<float>(density / length);
    fill_place(x, y, out);
}

/// Covariance on the screen, pixels², and its eigenvalues.
struct ScreenCovariance {
    double xx, xy, yy, large, small;
};
/// The view at the mean of a Gaussian.
struct MeanPoint {
    Double3 column, row;          ///< gradients of column and row, per scene unit
    Double3 per_column, per_row;  ///< scene units of one pixel, across the view
    double distance;              ///< along the view; infinite for parallel rays
};
VOG_HD ScreenCovariance screen_covariance(const Axes& axes, const MeanPoint& at) {
    const Double3 x = apply(axes.a, at.column), y = apply(axes.a, at.row);
    ScreenCovariance s;
    s.xx = dot(x, x), s.xy = dot(x, y), s.yy = dot(y, y);
    const double middle = 0.5 * (s.xx + s.yy), dif = 0.5 * (s.xx - s.yy);
    const double radius = sqrt(dif * dif + s.xy * s.xy);
    s.large = middle + radius, s.small = fmax(middle - radius, 0.0);
    return s;
}

/// Raises the variance along b, b b^T more, at constant mass: splat_widen-inl.h has the formulas.
VOG_HD void raise(Double3 b, double more, SplatSource& g) {
    const Double3 whitened = apply(g.axes.w, b);
    const double length = sqrt(dot(whitened, whitened));
    const Double3 q = (1 / length) * whitened;
    const double wider = sqrt(1 + more * length * length);
    const double part[3] = {q.x, q.y, q.z};
    const Double3 along = q.x * g.axes.w[0] + q.y * g.axes.w[1] + q.z * g.axes.w[2];
    for (int n = 0; n < 3; ++n) {
        g.axes.w[n] = g.axes.w[n] + part[n] * (1 / wider - 1) * along;
        g.axes.a[n] = g.axes.a[n] + part[n] * ((wider - 1) / length) * b;
    }
    g.density /= wider;
}

/// Widens a Gaussian whose screen covariance is `s` to the least variance.
VOG_HD void widen(const ScreenCovariance& s, double least2, const MeanPoint& at, SplatSource& g) {
    const double dif = 0.5 * (s.xx - s.yy), radius = sqrt(dif * dif + s.xy * s.xy);
    double x = dif >= 0 ? radius + dif : s.xy, y = dif >= 0 ? s.xy : radius - dif;
    const double length = sqrt(x * x + y * y);
    x = length > 0 ? x / length : 1, y = length > 0 ? y / length : 0;
    raise(x * at.per_row - y * at.per_column, fmax(least2 - s.small, 0.0), g);
    raise(x * at.per_column + y * at.per_row, fmax(least2 - s.large, 0.0), g);
}

/// Raises scales below a millionth of a pixel to that, at constant mass: they would leave no digits
/// to the difference in raise().
VOG_HD void keep_digits(double least, SplatSource& g) {
    for (int n = 0; n < 3; ++n) {
        const double scale = 1 / sqrt(dot(g.axes.w[n], g.axes.w[n]));
        if (scale >= least) continue;
        g.axes.w[n] = (scale / least) * g.axes.w[n];
        g.axes.a[n] = (least / scale) * g.axes.a[n];
        g.density *= scale / least;
    }
}

/// 1 up to `from`, 0 from `to`, linear between them.
VOG_HD double taper(double value, double from, double to) {
    return fmin(fmax((to - value) / (to - from), 0.0), 1.0);
}

/// tau / |D| of a far splat at a pixel, D the pixel's direction with forward component 1.
VOG_HD float far_depth(const TileSplat& s, const Kernel& kernel, int32_t column, int32_t row) {
    const float x = static_cast<float>(column - s.column) - s.offset_x;
    const float y = static_cast<float>(row - s.row) - s.offset_y;
    const float a = s.ax * x + s.ay * y;
    const float c = s.c0 + s.cx * x + s.cy * y, d = s.d0 + s.dy * y;
    const float per_c = 1 / (c * c + d * d + s.e02);
    const float m2 = (a * a + s.by2 * y * y) * per_c;
    if (!(m2 < kernel.cutoff2)) return 0;
    const float rest = kernel.cutoff2 - m2, v = kernel.slope * rest + kernel.shift;
    float sum = kernel.coefficient[kernel.degree];
    for (int n = kernel.degree - 1; n >= 0; --n) sum = sum * v + kernel.coefficient[n];
    // At large cutoffs the polynomial's error, of either sign, exceeds the kernel's tail.
    return s.weight * sqrtf(rest * per_c) * fmaxf(sum, 0.0f);
}

/// Share of tau that makes its sum over pixel centres the mass of a small Gaussian.
/// s      screen covariance as drawn
/// depth  standard deviation along the view over the distance
VOG_HD float share_of_sum(const TileSplat& splat, const SplatKernel& model,
                          const ScreenCovariance& s, double depth, double mass_on_screen) {
    const double half_x = model.cutoff * sqrt(s.xx), half_y = model.cutoff * sqrt(s.yy);
    const double share = taper(sqrt(s.small * model.variance), kTaperFromPx, kSampledDeviationPx) *
                         taper(fmax(half_x, half_y), kTaperHalfPx, kMostHalfPx) *
                         taper(model.cutoff * depth, kTaperHalfDepth, kMostHalfDepth);
    if (!(share > 0)) return 1;
    // In perspective an outline reaches farther from the mean: its nearest points are at 1 - k depth.
    const double nearest = 1 - model.cutoff * depth;
    const int32_t columns = static_cast<int32_t>(half_x / nearest + 0.5);
    const int32_t rows = static_cast<int32_t>(half_y / nearest + 0.5);
    double sum = 0;
    for (int32_t y = -rows; y <= rows; ++y)
        for (int32_t x = -columns; x <= columns; ++x)
            sum += far_depth(splat, model.kernel, splat.column + x, splat.row + y);
    const double integral = mass_on_screen * (1 + 3 * model.variance * depth * depth);
    const double excess = sum / integral - 1;
    if (!(excess > -0.9)) return 1;  // too faint for the sum's floats
    return static_cast<float>(1 / (1 + share * excess));
}

/// Widens a Gaussian that is too thin; sets out.widened.
/// returns  its screen covariance as drawn
VOG_HD ScreenCovariance drawn_covariance(const SplatKernel& model, const MeanPoint& at,
                                         SplatSource& g, TileSplat& out) {
    const ScreenCovariance screen = screen_covariance(g.axes, at);
    if (!(screen.small < model.least2)) return screen;
    out.widened = 1;
    keep_digits(1e-6 * sqrt(dot(at.per_column, at.per_column)), g);
    widen(screen_covariance(g.axes, at), model.least2, at, g);
    return screen_covariance(g.axes, at);
}

/// Divides a small splat by its sum over pixels; sets out.share.
/// mass    of the Gaussian, in units of peak 1 and standard deviations 1
/// extent  standard deviation along the view
VOG_HD void divide_by_sum(const SplatKernel& model, const MeanPoint& at,
                          const ScreenCovariance& screen, double mass, double extent,
                          TileSplat& out) {
    if (!(screen.small < model.sampled2)) return;
    // Over the screen tau / |D| has the integral mass over the area of a pixel there.
    const double area = sqrt(dot(at.per_column, at.per_column) * dot(at.per_row, at.per_row));
    out.share = share_of_sum(out, model, screen, extent / at.distance, mass * model.mass / area);
    out.weight *= out.share;
}

/// In units of peak 1 and standard deviations 1.
VOG_HD double mass_of(const SplatSource& g) {
    return g.density / fabs(dot(g.axes.w[0], cross(g.axes.w[1], g.axes.w[2])));
}

/// Projects a Gaussian for parallel rays.
/// returns  false if it covers no pixel of the image
VOG_HD bool project_parallel(SplatSource g, const Camera& camera, const SplatKernel& model,
                             TileSplat& out) {
    const double cutoff = model.cutoff;
    const Double3 v = g.mean - camera.eye;  // from the plane of the eye, at pixel (0, 0)
    const Double3 extent = apply(g.axes.a, camera.corner);
    const double z = dot(v, camera.corner), depth = cutoff * sqrt(dot(extent, extent));
    out.pixels = {0, camera.width - 1, 0, camera.height - 1};
    out.widened = 0;
    out.share = 1;
    out.near = !(z > 1.01 * depth);
    if (out.near) return z + depth > 0;
    const double per_x = 1 / dot(camera.shift_x, camera.shift_x);
    const double per_y = 1 / dot(camera.shift_y, camera.shift_y);
    const double x = dot(v, camera.shift_x) * per_x, y = dot(v, camera.shift_y) * per_y;
    const MeanPoint at{per_x * camera.shift_x, per_y * camera.shift_y, camera.shift_x,
                       camera.shift_y, HUGE_VAL};
    const double mass = mass_of(g);
    const ScreenCovariance screen = drawn_covariance(model, at, g, out);
    const double half_x = cutoff * sqrt(screen.xx), half_y = cutoff * sqrt(screen.yy);
    pixels_between(1, 0, -half_x * half_x, x, camera.width, out.pixels.x0, out.pixels.x1);
    pixels_between(1, 0, -half_y * half_y, y, camera.height, out.pixels.y0, out.pixels.y1);
    if (out.pixels.empty()) return false;
    fill_parallel(g.density, g.axes, camera, x, y, out);
    divide_by_sum(model, at, screen, mass, 0, out);
    return true;
}

/// Projects a Gaussian; one thinner than kLeastDeviationPx is widened.
/// returns  false if it covers no pixel of the image
VOG_HD bool project(SplatSource g, const Camera& camera, const SplatKernel& model, TileSplat& out) {
    if (camera.orthographic) return project_parallel(g, camera, model, out);
    const double cutoff = model.cutoff;
    const Double3 forward_steps = cross(camera.step_x, camera.step_y);
    const Double3 forward = (1 / sqrt(dot(forward_steps, forward_steps))) * forward_steps;
    const Double3 v = g.mean - camera.eye;
    Double3 extent = apply(g.axes.a, forward);
    const double z = dot(v, forward);
    double deviation = sqrt(dot(extent, extent));
    const double depth = cutoff * deviation;
    out.pixels = {0, camera.width - 1, 0, camera.height - 1};
    out.widened = 0;
    out.share = 1;
    out.near = !(z > 1.01 * depth);
    if (out.near) return z + depth > 0;

    // The mean's pixel, and the planes through the eye that touch the support: a column's plane
    // n + x n1 is at the whitened distance |(n + x n1)·v| / |A (n + x n1)| = k. About the column of
    // the mean, where n·v = 0, the quadratic has no cancelling terms.
    const double per_x = 1 / dot(camera.step_x, camera.step_x);
    const double per_y = 1 / dot(camera.step_y, camera.step_y);
    const Double3 ray = (1 / z) * v, slope = ray - camera.corner;
    const double x = dot(slope, camera.step_x) * per_x, y = dot(slope, camera.step_y) * per_y;
    const double farthest = 1e9;  // pixels: beyond any image, within an int
    if (!(fabs(x) < farthest && fabs(y) < farthest)) {
        out.near = 1;  // grazes the eye plane: rare, and exact as a near splat
        return true;
    }
    const Double3 right = (per_x / z) * camera.step_x, down = (per_y / z) * camera.step_y;
    const MeanPoint at_mean{right - dot(ray, right) * forward, down - dot(ray, down) * forward,
                            z * camera.step_x, z * camera.step_y, z};
    const double mass = mass_of(g);  // widening conserves it
    const ScreenCovariance screen = drawn_covariance(model, at_mean, g, out);
    extent = apply(g.axes.a, forward);
    deviation = sqrt(dot(extent, extent));
    const double k2 = cutoff * cutoff;
    const Double3 nx = cross(camera.step_y, ray), ny = cross(camera.step_x, ray);
    const Double3 anx = apply(g.axes.a, nx), any = apply(g.axes.a, ny);
    const Double3 turn = cross(camera.step_y, camera.step_x);
    const Double3 at = apply(g.axes.a, turn);
    const double tv = dot(turn, v), a = tv * tv - k2 * dot(at, at);
    pixels_between(a, -k2 * dot(anx, at), -k2 * dot(anx, anx), x, camera.width, out.pixels.x0,
                   out.pixels.x1);
    // Rows: their planes turn the other way, n + y step_x x step_y.
    pixels_between(a, k2 * dot(any, at), -k2 * dot(any, any), y, camera.height, out.pixels.y0,
                   out.pixels.y1);
    if (out.pixels.empty()) return false;
    fill_far(g.density, g.axes, camera, v, z, x, y, out);
    divide_by_sum(model, at_mean, screen, mass, deviation, out);
    return true;
}

/// Planes around the rays of a rectangle of pixels: inside, dot(normal, x - point) >= 0 for all four.
struct Frustum {
    Double3 normal[4], point[4];
};
VOG_HD Frustum frustum_of(const Camera& camera, const PixelRange& pixels) {
    const Double3 right = camera.step_x + camera.shift_x, down = camera.step_y + camera.shift_y;
    const double columns[2] = {static_cast<double>(pixels.x0), static_cast<double>(pixels.x1)};
    const double rows[2] = {static_cast<double>(pixels.y0), static_cast<double>(pixels.y1)};
    Frustum out;
    for (int n = 0; n < 2; ++n) {
        // A column's plane holds its rays and `down`; of a row likewise.
        const Double3 x = cross(down, camera.corner + columns[n] * camera.step_x);
        const Double3 y = cross(right, camera.corner + rows[n] * camera.step_y);
        const double inwards = n == 0 ? 1.0 : -1.0;
        out.normal[n] = copysign(1.0, inwards * dot(x, right)) * x;
        out.normal[2 + n] = copysign(1.0, inwards * dot(y, down)) * y;
        out.point[n] = camera.eye + columns[n] * camera.shift_x;
        out.point[2 + n] = camera.eye + rows[n] * camera.shift_y;
    }
    return out;
}

/// False only if the support lies outside one of the planes.
VOG_HD bool may_meet(const Gaussian& g, const Frustum& frustum, float cutoff2) {
    const Axes axes = axes_of(g);
    const Double3 mean = to_double(g.mean);
    // Slack for the whitening's floats, whose rows are at right angles within 1e-7.
    const double largest2 =
        dot(axes.a[0], axes.a[0]) + dot(axes.a[1], axes.a[1]) + dot(axes.a[2], axes.a[2]);
    for (int n = 0; n < 4; ++n) {
        const Double3 normal = frustum.normal[n], reach = apply(axes.a, normal);
        const double reach2 = dot(reach, reach) + 1e-12 * largest2 * dot(normal, normal);
        const double at = dot(normal, mean - frustum.point[n]);
        if (at < 0 && at * at > (1 + 1e-4) * cutoff2 * reach2) return false;
    }
    return true;
}

/// tau of a near splat along the ray of a pixel.
VOG_HD float near_depth(const Gaussian& g, const Ray& ray, float cutoff2) {
    Hit hit;
    return intersect(g, ray, cutoff2, hit) ? optical_depth(g, hit) : 0.0f;
}
/// The whole ray of a pixel, for near splats.
VOG_HD Ray whole_ray(const Camera& camera, int32_t column, int32_t row) {
    Ray ray;
    const double far = 1e30;
    const Bounds everywhere{{-far, -far, -far}, {far, far, far}};
    camera_ray(camera, everywhere, column, row, ray);
    return ray;
}

constexpr int kSplatTile = 16;  ///< edge of a tile, pixels: one block of 256 threads

/// Tiles that a range of pixels touches, inclusive.
VOG_HD PixelRange tiles_of(const PixelRange& pixels) {
    return {pixels.x0 / kSplatTile, pixels.x1 / kSplatTile, pixels.y0 / kSplatTile,
            pixels.y1 / kSplatTile};
}
/// Pixels of a tile, inclusive; some may lie beyond the picture.
VOG_HD PixelRange pixels_of(int32_t tile, int32_t tile_columns) {
    const int32_t x = tile % tile_columns * kSplatTile, y = tile / tile_columns * kSplatTile;
    return {x, x + kSplatTile - 1, y, y + kSplatTile - 1};
}
/// Tiles that list the splat: none for a near one, which is in a list of all tiles.
VOG_HD int64_t tile_count(const TileSplat& splat) {
    const PixelRange range = tiles_of(splat.pixels);
    return splat.near ? 0
                      : static_cast<int64_t>(range.x1 - range.x0 + 1) * (range.y1 - range.y0 + 1);
}

}  // namespace vog::device
