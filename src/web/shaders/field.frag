// field.frag: sums of a field along one pixel's ray through one Gaussian, added up by blending: tau, tau times the
// field's mean, tau times its mean square (docs/fields.md). Follows erf.glsl, chord.glsl.
#ifdef SCALAR
flat in vec4 plane;
flat in vec3 rest;
#else
flat in vec4 plane_r, plane_u, plane_f;
flat in vec3 rest_r, rest_uf;
uniform int magnitude;  // 1: no mean, and the mean square of the whole vector
#endif

layout(location = 0) out vec4 sums;

// Mean and variance of a normal distribution between the chord's ends, deviations.
vec2 moments(Chord chord, float mass) {
    float u = chord.end * chord.end;
    if (chord.whole) {
        // 1 - 2 z n(z) / (2 N(z) - 1) at z^2 = u; its series where the difference cancels
        float variance = u < 0.5 ? u * (1.0 / 3.0 - u * (2.0 / 45.0 - u * 0.0021164))
                                 : 1.0 - chord.end * exp(-0.5 * u) / (0.5 * sqrt(kTwoPi) * mass);
        return vec2(0.0, variance);
    }
    float width = chord.end - chord.start, middle = 0.5 * (chord.start + chord.end);
    if (width < 0.1) return vec2(middle, width * width / 12.0);
    float before = exp(-0.5 * chord.start * chord.start), after = exp(-0.5 * u), whole = sqrt(kTwoPi) * mass;
    float mean = (before - after) / whole;
    float variance = 1.0 + (chord.start * before - chord.end * after) / whole - mean * mean;
    return vec2(clamp(mean, chord.start, chord.end), clamp(variance, 0.0, width * width / 12.0));
}

void main() {
    sums = vec4(0.0);
    Chord chord;
    if (!chord_of_pixel(chord)) discard;
    float mass = chord.whole ? 2.0 * normal_to(chord.end) : normal_to(chord.end) - normal_to(chord.start);
    vec2 along = moments(chord, mass);
    float slant = length(chord.direction);
    vec3 at = chord.at + along.x * chord.deviation * chord.direction;
#ifdef SCALAR
    float value = plane.w + rest.z * dot(plane.xyz, at), rate = rest.z * dot(plane.xyz, chord.direction), variance = rest.x;
#else
    // The component along the ray.
    vec3 d = chord.direction / slant;
    mat3 gradient = mat3(plane_r.xyz, plane_u.xyz, plane_f.xyz);
    vec3 values = vec3(plane_r.w, plane_u.w, plane_f.w) + at * gradient, rates = chord.direction * gradient;
    float value = dot(d, values), rate = dot(d, rates);
    float variance = d.x * (rest_r.x * d.x + 2.0 * (rest_r.y * d.y + rest_r.z * d.z)) +
                     d.y * (rest_uf.x * d.y + 2.0 * rest_uf.y * d.z) + rest_uf.z * d.z * d.z;
    if (magnitude == 1) {
        variance = dot(values, values) + dot(rates, rates) * chord.deviation * chord.deviation * along.y + rest_r.x + rest_uf.x + rest_uf.z;
        value = rate = 0.0;
    }
#endif
    variance += rate * rate * chord.deviation * chord.deviation * along.y;
    float tau = chord.peak * slant * max(mass, 0.0);
    sums = vec4(tau, tau * value, tau * (value * value + variance), 0.0);
}
