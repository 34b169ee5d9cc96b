// splat.frag: exact line integral of one truncated Gaussian along one pixel's ray, summed to T by
// additive blending. With (x, y) the pixel from the projected mean and d = toward + x step_x +
// y step_y the whitened direction, |d| = 1 at the mean:
//   m^2 C = (ax x + ay y)^2 + (by y)^2      the squared cross product of mean and direction
//   C     = |d|^2
// sums of squares, so nothing cancels (docs/method.md). The pixel is taken from gl_FragCoord:
// interpolated positions are off by up to 1/256 of a pixel. Parallel rays: d has no steps; near supports
// step from origin to origin.
flat in vec4 center_ax_ay;
flat in vec4 toward_by;
flat in vec4 step_x_weight;
flat in vec4 step_y_near;

uniform vec2 size_px;
uniform vec2 jitter_px;
uniform float pixels_per_unit;
uniform float cutoff;
uniform float parallel;  // 1: parallel rays

layout(location = 0) out vec4 depth;

const float kTwoPi = 6.28318530717958647;

// Abramowitz and Stegun 7.1.26, for x >= 0: absolute error below 1.5e-7.
float erf_positive(float x) {
    float t = 1.0 / (1.0 + 0.3275911 * x);
    float sum = ((((1.061405429 * t - 1.453152027) * t + 1.421413741) * t - 0.284496736) * t + 0.254829592) * t;
    return 1.0 - sum * exp(-x * x);
}
float erf_any(float x) { return sign(x) * erf_positive(abs(x)); }

void main() {
    vec2 pixel = gl_FragCoord.xy - 0.5 * size_px;
    vec2 slope = (pixel + jitter_px) / pixels_per_unit;
    float slant = sqrt(1.0 + (1.0 - parallel) * dot(slope, slope));  // world length per unit of depth
    vec3 step_x = step_x_weight.xyz, step_y = step_y_near.xyz;
    float k2 = cutoff * cutoff;
    depth = vec4(0.0);

    if (step_y_near.w == 0.0) {
        vec2 at = pixel - center_ax_ay.xy;
        vec3 d = toward_by.xyz + (1.0 - parallel) * (at.x * step_x + at.y * step_y);
        float c = dot(d, d);
        float a = center_ax_ay.z * at.x + center_ax_ay.w * at.y, b = toward_by.w * at.y;
        float m2 = (a * a + b * b) / c;
        if (m2 >= k2) discard;
        depth.r = step_x_weight.w * slant * sqrt(kTwoPi / c) * exp(-0.5 * m2) *
                  erf_positive(sqrt(0.5 * (k2 - m2)));
        return;
    }
    // Support around or beside the eye: the segment starts at the eye.
    vec2 at = pixel + jitter_px;
    vec3 step = at.x * step_x + at.y * step_y;
    vec3 e = center_ax_ay.xyz - parallel * step;
    vec3 d = toward_by.xyz + (1.0 - parallel) * step;
    float c = dot(d, d);
    vec3 offset = cross(e, d);
    float m2 = dot(offset, offset) / c;
    if (m2 >= k2) discard;
    float end = sqrt(0.5 * (k2 - m2));                  // half the segment, in erf's units
    float begin = max(-end, -dot(e, d) / sqrt(2.0 * c));  // entry point, or the eye
    if (begin >= end) discard;
    depth.r = step_x_weight.w * slant * sqrt(0.25 * kTwoPi / c) * exp(-0.5 * m2) *
              (erf_any(end) - erf_any(begin));
}
