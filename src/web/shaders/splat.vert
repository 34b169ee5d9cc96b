// splat.vert: screen quad of a Gaussian's projected support, and the inputs of splat.frag. All lengths
// are relative to the eye in units of the model's radius, so that floats suffice.
// Shared by WebGL2 and OpenGL 3.3; the #version line is prepended at run time, and a word for what is drawn:
//   (none)         T: splat.frag
//   SCALAR, VECTOR sums of a field, and all that is clipped: field.frag
//   SLABS, LIT     moments of a field in depth slabs, with its gradient: slab.frag
//   MEANS          densities and means of a field in depth slabs: slab.frag
//   RANGES         the range of all depths: ranges.frag
//   TILES          that of each tile of tiles.glsl
#if defined(MEANS) || defined(LIT)
#define SLABS
#endif
#ifdef TILES
#define RANGES
const float kTile = 16.0;
#endif
layout(location = 0) in vec4 mean_density;  // mean relative to the model's centre; peak density
layout(location = 1) in vec3 scale;         // standard deviations
layout(location = 2) in vec4 rotation;      // unit quaternion w x y z

uniform vec3 eye;                    // relative to the model's centre, along right, up and forward
uniform vec3 right, up, forward;     // camera axes
#if defined(SCALAR) || defined(SLABS)
// Value at the mean, its change over a standard deviation along each own axis; deviation and skewness of the
// residual. In units of the picture.
layout(location = 3) in vec4 field_plane;
layout(location = 4) in vec2 field_rest;
#endif
#ifdef VECTOR
// The same of the components along x, y and z; covariance of the residual: xx xy xz yy, yz zz.
layout(location = 3) in vec4 plane_x;
layout(location = 4) in vec4 plane_y;
layout(location = 5) in vec4 plane_z;
layout(location = 6) in vec4 covariance;
layout(location = 7) in vec2 covariance_rest;
#endif

uniform vec2 size_px;                // image size
uniform vec2 jitter_px;              // offset of each ray from its pixel's centre
uniform float pixels_per_unit;       // pixels per unit of slope, right / forward, or of length if parallel
uniform float parallel;              // 1: orthographic camera, parallel rays; 0: pinhole
uniform float cutoff;                // standard deviations
uniform vec4 limits;                 // of small Gaussians (render/pixel_limits.h): smallest variance drawn, variance
                                     // from which pixel centres are exact, variance and mass of the kernel

#ifdef SLABS
uniform highp sampler2D ranges;      // of all depths: minus the least, the largest
uniform float slabs, first_slab, layers;  // of the picture; those of this pass
const float kShift = 0.5, kPerUnit = 0.5;  // shares of the field's range, which is -1 to 1
#else
const float kShift = 0.0, kPerUnit = 1.0;
#endif

#ifdef RANGES
flat out vec2 range;         // minus the least depth, the largest
#else
flat out vec4 center_ax_ay;  // projected mean, pixels from the image's centre; ax, ay of splat.frag
flat out vec4 toward_by;     // unit whitened direction through the mean; by
flat out vec4 step_x_weight;
flat out vec4 step_y_near;   // near = 1: the exact segment form
#endif
#if defined(SCALAR) || defined(VECTOR) || defined(SLABS)
flat out vec4 place;         // mean along right, up and forward; far: deviation along the ray through it, as a depth
#endif
#if defined(SCALAR) || defined(SLABS)
flat out vec4 plane;         // gradient along right, up and forward; value
flat out vec3 rest;          // variance and third central moment; 0: constant along rays
#endif
#ifdef VECTOR
flat out vec4 plane_r, plane_u, plane_f;  // of the components along right, up and forward
flat out vec3 rest_r, rest_uf;            // covariance: rr ru rf, uu uf ff
#endif

// Tapers of small Gaussians: render/device/pixel_limits.h.
const vec2 kTaperPx = vec2(1.75, 2.0), kTaperHalfPx = vec2(5.0, 6.0), kTaperHalfDepth = vec2(0.1, 0.2);
const float kTwoPi = 6.28318530717958647;
const float kInFront = 1.01;  // supports at this multiple of their extent before the eye plane are far
const vec4 kNowhere = vec4(2.0, 2.0, 2.0, 1.0);

mat3 rotation_matrix(vec4 q) {
    float w = q.x, x = q.y, y = q.z, z = q.w;
    return mat3(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y),
                2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x),
                2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y));
}

// Whether the support is outside a side of the view frustum, the plane slope * forward = across; if
// parallel slope = across.
bool beyond(float slope, float across, float depth, vec3 s_across, vec3 s_forward) {
    vec3 normal = slope * (1.0 - parallel) * s_forward - s_across;
    float gap = slope * mix(depth, 1.0, parallel) - across;
    return gap < 0.0 && gap * gap > dot(normal, normal);
}

// Slopes of the two planes through the eye tangent to the support: mean and half difference. The
// discriminant is a difference of squared vectors, so nothing cancels far from the eye. If parallel,
// the planes along the view: their offsets.
vec2 tangents(float across, float depth, vec3 s_across, vec3 s_forward) {
    if (parallel == 1.0) return vec2(across, length(s_across));
    float leading = depth * depth - dot(s_forward, s_forward);
    vec3 a = depth * s_across - across * s_forward, b = cross(s_across, s_forward);
    return vec2(across * depth - dot(s_across, s_forward),
                sqrt(max(0.0, dot(a, a) - dot(b, b)))) / leading;
}

// A Gaussian along the camera's axes, in its own axes: axes times and over the scales.
struct Shape {
    vec3 spread_r, spread_u, spread_f;
    vec3 white_r, white_u, white_f;
    float density;
};

// Covariance on the screen, pixels^2: xx, xy, yy. The smaller eigenvalue, by the determinant: a
// difference of the larger from the trace would cancel for needles.
struct ScreenCovariance {
    vec3 matrix;
    float large, small;
};
ScreenCovariance screen_covariance(Shape g, vec3 mean) {
    float scale = pixels_per_unit / mean.z;
    vec3 x = scale * (g.spread_r - (mean.x / mean.z) * g.spread_f);
    vec3 y = scale * (g.spread_u - (mean.y / mean.z) * g.spread_f);
    float xx = dot(x, x), xy = dot(x, y), yy = dot(y, y);
    vec3 area = cross(x, y);
    float large = 0.5 * (xx + yy) + length(vec2(0.5 * (xx - yy), xy));
    return ScreenCovariance(vec3(xx, xy, yy), large, large > 0.0 ? dot(area, area) / large : 0.0);
}

// Raises the screen variance along the unit vector v by `more` pixels^2, at constant mass
// (src/render/splat/splat_widen-inl.h).
void raise(vec2 v, float more, float unit_per_pixel, inout Shape g) {
    vec2 b = unit_per_pixel * v;
    vec3 q = b.x * g.white_r + b.y * g.white_u;
    float size = length(q);
    q /= size;
    float wider = sqrt(1.0 + more * size * size);
    g.spread_r += q * ((wider - 1.0) / size * b.x);
    g.spread_u += q * ((wider - 1.0) / size * b.y);
    vec3 less = q * (1.0 / wider - 1.0);
    g.white_r += less * dot(q, g.white_r);
    g.white_u += less * dot(q, g.white_u);
    g.white_f += less * dot(q, g.white_f);
    g.density /= wider;
}

Shape shape_of(mat3 own_from_world, vec3 deviations, float density) {
    vec3 r = own_from_world * right, u = own_from_world * up, f = own_from_world * forward;
    return Shape(deviations * r, deviations * u, deviations * f, r / deviations, u / deviations,
                 f / deviations, density);
}

// The Gaussian, raised to the smallest variance drawn.
Shape widened(mat3 own_from_world, vec3 mean) {
    // Scales below a hundredth of a pixel leave no digits to 1 / wider - 1: raised to that first.
    float unit_per_pixel = mean.z / pixels_per_unit;
    vec3 kept = max(scale, vec3(0.01 * unit_per_pixel)), part = scale / kept;
    Shape g = shape_of(own_from_world, kept, mean_density.w * part.x * part.y * part.z);
    ScreenCovariance s = screen_covariance(g, mean);
    float dif = 0.5 * (s.matrix.x - s.matrix.z), radius = length(vec2(dif, s.matrix.y));
    vec2 v = dif >= 0.0 ? vec2(radius + dif, s.matrix.y) : vec2(s.matrix.y, radius - dif);
    float size = length(v);
    v = size > 0.0 ? v / size : vec2(1.0, 0.0);
    raise(vec2(-v.y, v.x), max(limits.x - s.small, 0.0), unit_per_pixel, g);
    raise(v, max(limits.x - s.large, 0.0), unit_per_pixel, g);
    return g;
}

// The integral along a ray over that of an endless one through the mean, for rest = k^2 - m^2. With
// erf as in splat.frag.
float kernel(float rest) {
    float x = sqrt(0.5 * rest), t = 1.0 / (1.0 + 0.3275911 * x);
    float sum = ((((1.061405429 * t - 1.453152027) * t + 1.421413741) * t - 0.284496736) * t + 0.254829592) * t;
    return exp(0.5 * (rest - cutoff * cutoff)) * (1.0 - sum * exp(-x * x));
}

float taper(float value, vec2 range) { return clamp((range.y - value) / (range.y - range.x), 0.0, 1.0); }

// Share of tau that makes its sum over pixel centres the mass of a small Gaussian. The forms are those
// of splat.frag.
float share_of_sum(Shape g, vec3 mean, vec2 center, vec2 a, float b, vec3 toward, vec3 dx, vec3 dy, float weight) {
    ScreenCovariance s = screen_covariance(g, mean);
    float deviation = sqrt(min(s.small, limits.y) * limits.z), depth = (1.0 - parallel) * length(g.spread_f) / mean.z;
    vec2 half_extent = cutoff * sqrt(s.matrix.xz);
    float share = taper(deviation, kTaperPx) * taper(max(half_extent.x, half_extent.y), kTaperHalfPx) *
                  taper(cutoff * depth, kTaperHalfDepth);
    if (share == 0.0) return 1.0;
    vec2 pixel = size_px * 0.5 + center;  // pixel centres are at halves
    vec2 nearest = floor(pixel) + 0.5 - pixel;
    ivec2 reach = ivec2(1.05 * half_extent + 0.5);  // perspective lengthens outlines by 4 % at most
    float sum = 0.0;
    for (int row = -reach.y; row <= reach.y; ++row)
        for (int column = -reach.x; column <= reach.x; ++column) {
            vec2 at = nearest + vec2(float(column), float(row));
            vec3 d = toward + at.x * dx + at.y * dy;
            float c = dot(d, d), across = a.x * at.x + a.y * at.y;
            float rest = cutoff * cutoff - (across * across + b * b * at.y * at.y) / c;
            if (rest > 0.0) sum += kernel(rest) / sqrt(c);
        }
    float per_unit = pixels_per_unit / mean.z;
    float mass = mean_density.w * scale.x * scale.y * scale.z * limits.w;
    float integral = mass * per_unit * per_unit * (1.0 + 3.0 * limits.z * depth * depth);
    float excess = weight * sqrt(kTwoPi) * sum / integral - 1.0;
    return excess > -0.9 && excess < 1e4 ? 1.0 / (1.0 + share * excess) : 1.0;
}

#if defined(SCALAR) || defined(VECTOR) || defined(SLABS)
// Gradient along the camera's axes of a plane that changes by h over a deviation along each own axis.
vec3 gradient_of(Shape g, vec3 h) { return vec3(dot(h, g.white_r), dot(h, g.white_u), dot(h, g.white_f)); }
#endif

#if defined(SCALAR) || defined(VECTOR) || defined(SLABS)
// What fields need. A Gaussian drawn wider than it is counts as a point: constant, with its whole variance.
// drawn  g, or wider
void set_field(Shape g, Shape drawn, vec3 mean, bool wide) {
    vec3 e = mean.x * drawn.white_r + mean.y * drawn.white_u + mean.z * drawn.white_f;
    place = vec4(mean, parallel == 1.0 ? 1.0 / length(drawn.white_f) : mean.z / length(e));
#if defined(SCALAR) || defined(SLABS)
    vec3 h = kPerUnit * field_plane.yzw;
    float r = kPerUnit * field_rest.x;
    plane = vec4(gradient_of(g, h), kShift + kPerUnit * field_plane.x);
    rest = vec3(r * r + (wide ? limits.z * dot(h, h) : 0.0), field_rest.y * r * r * r, wide ? 0.0 : 1.0);
#endif
#ifdef VECTOR
    mat3 turn = transpose(mat3(right, up, forward));  // camera's components from the world's
    vec3 value = turn * vec3(plane_x.x, plane_y.x, plane_z.x);
    // Columns: the components' changes over a deviation.
    mat3 h = mat3(plane_x.yzw, plane_y.yzw, plane_z.yzw) * transpose(turn);
    mat3 r = mat3(covariance.xyz, vec3(covariance.y, covariance.w, covariance_rest.x),
                  vec3(covariance.z, covariance_rest));
    r = turn * r * transpose(turn);
    if (wide) r += limits.z * transpose(h) * h;
    plane_r = vec4(wide ? vec3(0.0) : gradient_of(g, h[0]), value.x);
    plane_u = vec4(wide ? vec3(0.0) : gradient_of(g, h[1]), value.y);
    plane_f = vec4(wide ? vec3(0.0) : gradient_of(g, h[2]), value.z);
    rest_r = r[0];
    rest_uf = vec3(r[1].yz, r[2].z);
#endif
}
#endif

void main() {
    mat3 own_from_world = transpose(rotation_matrix(rotation));
    vec3 mean = vec3(dot(mean_density.xyz, right), dot(mean_density.xyz, up), dot(mean_density.xyz, forward)) - eye;
    float x = mean.x, y = mean.y, z = mean.z;
    Shape g = shape_of(own_from_world, scale, mean_density.w);
    bool far = z >= kInFront * cutoff * length(g.spread_f);
    vec3 at = mix(mean, vec3(0.0, 0.0, 1.0), parallel);  // parallel rays: no slope, and no size by distance
    float least = far ? screen_covariance(g, at).small : 0.0;
    bool wide = far && least < limits.x;
    if (wide) g = widened(own_from_world, at);
    vec3 s_r = cutoff * g.spread_r, s_u = cutoff * g.spread_u, s_f = cutoff * g.spread_f;
    float extent = length(s_f);
    vec2 side = 0.5 * (size_px + 1.0) / pixels_per_unit;  // half a pixel wider, for jittered rays

    gl_Position = kNowhere;
#ifndef RANGES
    center_ax_ay = toward_by = step_x_weight = step_y_near = vec4(0.0);
#endif
    if (z + extent <= 0.0 || beyond(side.x, x, z, s_r, s_f) || beyond(side.x, -x, z, -s_r, s_f) ||
        beyond(side.y, y, z, s_u, s_f) || beyond(side.y, -y, z, -s_u, s_f))
        return;

    // The whitened vector to the mean, and the steps of one pixel right and down.
    vec3 e = x * g.white_r + y * g.white_u + z * g.white_f;
    vec3 dx = g.white_r / pixels_per_unit, dy = -g.white_u / pixels_per_unit;
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    vec2 half_px = 0.5 * size_px;

    vec2 low, high;
    if (far) {
        vec2 tx = tangents(x, z, s_r, s_f) * pixels_per_unit, ty = tangents(y, z, s_u, s_f) * pixels_per_unit;
        low = vec2(tx.x - tx.y, -ty.x - ty.y) - jitter_px;
        high = vec2(tx.x + tx.y, -ty.x + ty.y) - jitter_px;
    } else {
        low = -half_px, high = half_px;
    }
#if defined(RANGES) || defined(SLABS)
    // Pixels whose centres lie in the bounds, as src/render/splat has them: ranges of depth are equal.
    const float kSlack = 1e-4;  // pixels
    vec2 first_px = max(ceil(low + half_px - 0.5 - kSlack), 0.0);
    vec2 last_px = min(floor(high + half_px - 0.5 + kSlack), size_px - 1.0);
    if (any(lessThan(last_px, first_px))) return;
    vec2 depths = max(vec2(z - extent, z + extent), 0.0);
#endif
    const float kPad = 0.02;  // pixels; covers float rounding, and fragments outside add nothing
    low = max(low - kPad, -half_px), high = min(high + kPad, half_px);
    if (any(lessThanEqual(high, low))) return;
#ifdef RANGES
    range = vec2(-depths.x, depths.y);
    gl_Position = vec4(corner, 0.0, 1.0);  // one pixel
#ifdef TILES
    vec2 in_tiles = floor(mix(first_px, last_px + kTile, 0.5 * corner + 0.5) / kTile);
    gl_Position.xy = 2.0 * in_tiles / ceil(size_px / kTile) - 1.0;
#endif
#else
#ifdef SLABS
    // A Gaussian beside this pass's slabs.
    vec2 all = texelFetch(ranges, ivec2(0), 0).xy, met = (depths + all.x) * slabs / (all.x + all.y) - first_slab;
    if (met.y < -0.001 || met.x > layers + 0.001) return;
#endif
    gl_Position = vec4(mix(low, high, 0.5 * corner + 0.5) / half_px, 0.0, 1.0);  // row 0 of the target is the top of the image
#if defined(SCALAR) || defined(VECTOR) || defined(SLABS)
    set_field(shape_of(own_from_world, scale, mean_density.w), g, mean, wide);
#endif

    if (!far) {
        center_ax_ay = vec4(e, 0.0);
        toward_by = vec4(g.white_f, 0.0);
        step_x_weight = vec4(dx, g.density);
        step_y_near = vec4(dy, 1.0);
        return;
    }
    if (parallel == 1.0) {
        vec3 along = g.white_f;
        float per_length = 1.0 / length(along);
        along *= per_length;
        vec3 px = cross(along, dx), py = cross(along, dy);
        float ax = length(px), ay = dot(px, py) / ax, by = abs(dot(along, cross(dx, dy))) / ax;
        vec2 center = vec2(x, -y) * pixels_per_unit - jitter_px;
        float weight = g.density * per_length;
        if (least < limits.y)
            weight *= share_of_sum(g, at, center, vec2(ax, ay), by, along, vec3(0.0), vec3(0.0), weight);
        center_ax_ay = vec4(center, ax, ay);
        toward_by = vec4(along, by);
        step_x_weight = vec4(dx, weight);
        step_y_near = vec4(dy, 0.0);
        return;
    }
    // Directions scaled so that the direction through the mean has length 1.
    float e_length = length(e), to_unit = z / e_length;
    dx *= to_unit, dy *= to_unit;
    vec3 px = cross(e, dx), py = cross(e, dy);
    float ax = length(px), ay = dot(px, py) / ax, by = e_length * abs(dot(e, cross(dx, dy))) / ax;
    vec2 center = vec2(x, -y) * (pixels_per_unit / z) - jitter_px;
    vec3 toward = e / e_length;
    float weight = g.density * to_unit;
    if (least < limits.y) weight *= share_of_sum(g, at, center, vec2(ax, ay), by, toward, dx, dy, weight);
    center_ax_ay = vec4(center, ax, ay);
    toward_by = vec4(toward, by);
    step_x_weight = vec4(dx, weight);
    step_y_near = vec4(dy, 0.0);
#endif
}
