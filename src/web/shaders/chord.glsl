// chord.glsl: the part of a pixel's ray inside one Gaussian, for field.frag and slab.frag, after erf.glsl; the forms are
// those of splat.frag. Along the ray of direction D, whose component along the view is 1, depths t are measured along the
// view; the Gaussian is a normal distribution about t* with some deviation, cut at u = -reach and reach deviations,
// at the eye and where the clip ends.
flat in vec4 center_ax_ay;
flat in vec4 toward_by;
flat in vec4 step_x_weight;
flat in vec4 step_y_near;
flat in vec4 place;

uniform vec2 size_px;
uniform vec2 jitter_px;
uniform float first_row;        // of the image, in the target's row 0
uniform float pixels_per_unit;
uniform float cutoff;
uniform float parallel;         // 1: parallel rays
uniform int clip_planes;        // number of planes
uniform vec4 clip_plane[16];    // normal along right, up and forward, offset: what stays has n.x >= offset from the eye

const float kTwoPi = 6.28318530717958647;

struct Chord {
    vec3 direction;    // D along right, up and forward
    vec3 at;           // point of the ray at t*, from the mean
    float nearest;     // t*
    float deviation;   // as a depth
    float peak;        // integral of the density along the whole normal distribution, over |D|
    float start, end;  // deviations from t*
    bool whole;        // from -reach to reach
};

// Keeps of a ray what planes leave: depths.
vec2 clipped(vec3 origin, vec3 direction) {
    vec2 kept = vec2(-3e38, 3e38);
    for (int n = 0; n < clip_planes; ++n) {
        float slope = dot(clip_plane[n].xyz, direction), gap = clip_plane[n].w - dot(clip_plane[n].xyz, origin);
        if (slope > 0.0) kept.x = max(kept.x, gap / slope);
        else if (slope < 0.0) kept.y = min(kept.y, gap / slope);
        else if (gap > 0.0) kept.y = -3e38;
    }
    return kept;
}

// False: the ray misses.
bool chord_of_pixel(out Chord chord) {
    vec2 pixel = gl_FragCoord.xy + vec2(0.0, first_row) - 0.5 * size_px;
    vec2 slope = (pixel + jitter_px) * vec2(1.0, -1.0) / pixels_per_unit;  // right, up
    vec3 direction = vec3((1.0 - parallel) * slope, 1.0), origin = vec3(parallel * slope, 0.0);
    vec3 mean = place.xyz, step_x = step_x_weight.xyz, step_y = step_y_near.xyz;
    float k2 = cutoff * cutoff, m2, c;
    chord.direction = direction;
    if (step_y_near.w == 0.0) {
        vec2 at = pixel - center_ax_ay.xy;
        vec3 moved = at.x * step_x + at.y * step_y;  // W of the ray's offset; parallel: from mean's ray
        vec3 d = toward_by.xyz + (1.0 - parallel) * moved;
        c = dot(d, d);
        float a = center_ax_ay.z * at.x + center_ax_ay.w * at.y, b = toward_by.w * at.y;
        m2 = (a * a + b * b) / c;
        if (m2 >= k2) return false;
        float q = dot(moved, d) / c;  // t* over the mean's depth is 1 - q; parallel: -q deviations from the mean
        vec3 aside = vec3(vec2(at.x, -at.y) / pixels_per_unit, 0.0);
        chord.deviation = place.w / sqrt(c);
        if (parallel == 1.0) {
            chord.nearest = mean.z - q * place.w;
            chord.at = vec3(aside.xy, -q * place.w);
        } else {
            chord.nearest = mean.z * (1.0 - q);
            chord.at = mean.z * (1.0 - q) * aside - q * mean;
        }
        chord.peak = step_x_weight.w * sqrt(kTwoPi / c) * exp(-0.5 * m2);
    } else {
        vec2 at = pixel + jitter_px;
        vec3 moved = at.x * step_x + at.y * step_y;
        vec3 e = center_ax_ay.xyz - parallel * moved;
        vec3 d = toward_by.xyz + (1.0 - parallel) * moved;
        c = dot(d, d);
        vec3 offset = cross(e, d);
        m2 = dot(offset, offset) / c;
        if (m2 >= k2) return false;
        chord.nearest = dot(e, d) / c;
        chord.deviation = inversesqrt(c);
        chord.at = origin + chord.nearest * direction - mean;
        chord.peak = step_x_weight.w * sqrt(kTwoPi / c) * exp(-0.5 * m2);
    }
    float reach = sqrt(k2 - m2);
    vec2 kept = clipped(origin, direction);
    kept.x = max(kept.x, 0.0);  // the eye
    kept = clamp((kept - chord.nearest) / chord.deviation, -reach, reach);
    chord.start = kept.x;
    chord.end = kept.y;
    chord.whole = kept.x == -reach && kept.y == reach;
    return chord.start < chord.end;
}
