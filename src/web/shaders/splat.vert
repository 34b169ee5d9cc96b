// splat.vert: screen quad of a Gaussian's projected support, and the inputs of splat.frag. All lengths
// are relative to the eye in units of the model's radius, so that floats suffice.
// Shared by WebGL2 and OpenGL 3.3; the #version line is prepended at run time.
layout(location = 0) in vec4 mean_density;  // mean relative to the model's centre; peak density
layout(location = 1) in vec3 scale;         // standard deviations
layout(location = 2) in vec4 rotation;      // unit quaternion w x y z

uniform vec3 eye;                    // relative to the model's centre, along right, up and forward
uniform vec3 right, up, forward;     // camera axes
uniform vec2 size_px;                // image size
uniform vec2 jitter_px;              // offset of each ray from its pixel's centre
uniform float pixels_per_unit;       // pixels per unit of slope, right / forward, or of length if parallel
uniform float parallel;              // 1: orthographic camera, parallel rays; 0: pinhole
uniform float cutoff;                // standard deviations

flat out vec4 center_ax_ay;  // projected mean, pixels from the image's centre; ax, ay of splat.frag
flat out vec4 toward_by;     // unit whitened direction through the mean; by
flat out vec4 step_x_weight;
flat out vec4 step_y_near;   // near = 1: the exact segment form

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

void main() {
    mat3 own_from_world = transpose(rotation_matrix(rotation));
    vec3 mean = mean_density.xyz;
    float x = dot(mean, right) - eye.x, y = dot(mean, up) - eye.y, z = dot(mean, forward) - eye.z;
    vec3 axis_r = own_from_world * right, axis_u = own_from_world * up, axis_f = own_from_world * forward;
    vec3 s_r = cutoff * scale * axis_r, s_u = cutoff * scale * axis_u, s_f = cutoff * scale * axis_f;
    float extent = length(s_f);
    vec2 side = 0.5 * (size_px + 1.0) / pixels_per_unit;  // half a pixel wider, for jittered rays

    gl_Position = kNowhere;
    center_ax_ay = toward_by = step_x_weight = step_y_near = vec4(0.0);
    if (z + extent <= 0.0 || beyond(side.x, x, z, s_r, s_f) || beyond(side.x, -x, z, -s_r, s_f) ||
        beyond(side.y, y, z, s_u, s_f) || beyond(side.y, -y, z, -s_u, s_f))
        return;

    // The whitened vector to the mean, and the steps of one pixel right and down.
    vec3 e = (x * axis_r + y * axis_u + z * axis_f) / scale;
    vec3 dx = axis_r / (scale * pixels_per_unit), dy = -axis_u / (scale * pixels_per_unit);
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    vec2 half_px = 0.5 * size_px;

    bool far = z >= kInFront * extent;
    vec2 low, high;
    if (far) {
        vec2 tx = tangents(x, z, s_r, s_f) * pixels_per_unit, ty = tangents(y, z, s_u, s_f) * pixels_per_unit;
        const float kPad = 0.02;  // pixels; covers float rounding, and fragments outside add nothing
        low = vec2(tx.x - tx.y, -ty.x - ty.y) - jitter_px - kPad;
        high = vec2(tx.x + tx.y, -ty.x + ty.y) - jitter_px + kPad;
        low = max(low, -half_px), high = min(high, half_px);
        if (any(lessThanEqual(high, low))) return;
    } else {
        low = -half_px, high = half_px;
    }
    vec2 at = mix(low, high, 0.5 * corner + 0.5) / half_px;
    gl_Position = vec4(at, 0.0, 1.0);  // row 0 of the target is the top of the image

    if (!far) {
        center_ax_ay = vec4(e, 0.0);
        toward_by = vec4(axis_f / scale, 0.0);
        step_x_weight = vec4(dx, mean_density.w);
        step_y_near = vec4(dy, 1.0);
        return;
    }
    if (parallel == 1.0) {
        vec3 along = axis_f / scale;
        float per_length = 1.0 / length(along);
        along *= per_length;
        vec3 px = cross(along, dx), py = cross(along, dy);
        float ax = length(px);
        center_ax_ay = vec4(vec2(x, -y) * pixels_per_unit - jitter_px, ax, dot(px, py) / ax);
        toward_by = vec4(along, abs(dot(along, cross(dx, dy))) / ax);
        step_x_weight = vec4(vec3(0.0), mean_density.w * per_length);
        return;
    }
    // Directions scaled so that the direction through the mean has length 1.
    float e_length = length(e), to_unit = z / e_length;
    dx *= to_unit, dy *= to_unit;
    vec3 px = cross(e, dx), py = cross(e, dy);
    float ax = length(px);
    vec2 center = vec2(x, -y) * (pixels_per_unit / z) - jitter_px;
    center_ax_ay = vec4(center, ax, dot(px, py) / ax);
    toward_by = vec4(e / e_length, e_length * abs(dot(e, cross(dx, dy))) / ax);
    step_x_weight = vec4(dx, mean_density.w * to_unit);
    step_y_near = vec4(dy, 0.0);
}
