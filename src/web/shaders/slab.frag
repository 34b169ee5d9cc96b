// slab.frag: moments of a field's values along one pixel's ray through one Gaussian, in the depth slabs of a pass, added up by
// blending (render/device/value_moments.h): in each the exact part of the integral over |D|, times 1, phi, phi^2 + r^2, phi^3 +
// 3 phi r^2 + third, at the plane's value phi in the middle of the part. Values are shares of the field's range.
// Four slabs; LIT: two, each with its part times the gradient; MEANS: eight, two moments each. Follows erf.glsl, chord.glsl.
#if defined(MEANS)
const int kSlabs = 8;
#elif defined(LIT)
const int kSlabs = 2;
#else
const int kSlabs = 4;
#endif
flat in vec4 plane;
flat in vec3 rest;

uniform highp sampler2D ranges;  // of all depths: minus the least, the largest
uniform float slabs, first_slab;
uniform float central;  // 1: moments of the residual alone, for sums in half floats, whose differences would be noise

layout(location = 0) out vec4 layer_0;
layout(location = 1) out vec4 layer_1;
layout(location = 2) out vec4 layer_2;
layout(location = 3) out vec4 layer_3;

void main() {
    layer_0 = layer_1 = layer_2 = layer_3 = vec4(0.0);
    Chord chord;
    if (!chord_of_pixel(chord)) discard;
    vec2 range = texelFetch(ranges, ivec2(0), 0).xy;
    float thickness = (range.x + range.y) / slabs;
    // Ends of the slabs in deviations; beyond the first and the last there is nothing.
    float edge[kSlabs + 1];
    for (int n = 0; n <= kSlabs; ++n) {
        float depth = thickness * (first_slab + float(n)) - range.x;
        edge[n] = clamp((depth - chord.nearest) / chord.deviation, chord.start, chord.end);
        if (first_slab + float(n) >= slabs) edge[n] = chord.end;
    }
    if (first_slab == 0.0) edge[0] = chord.start;
    if (edge[0] == edge[kSlabs]) discard;
    float at = plane.w + rest.z * dot(plane.xyz, chord.at), change = rest.z * dot(plane.xyz, chord.direction) * chord.deviation;
    float before = normal_to(edge[0]);
    vec4 sum[kSlabs];
    for (int n = 0; n < kSlabs; ++n) {
        float after = normal_to(edge[n + 1]), phi = at + 0.5 * (edge[n] + edge[n + 1]) * change, raw = (1.0 - central) * phi;
        sum[n] = chord.peak * max(after - before, 0.0) * vec4(1.0, phi, raw * phi + rest.x, (raw * phi + 3.0 * rest.x) * raw + rest.y);
        before = after;
    }
#if defined(MEANS)
    layer_0 = vec4(sum[0].xy, sum[1].xy), layer_1 = vec4(sum[2].xy, sum[3].xy);
    layer_2 = vec4(sum[4].xy, sum[5].xy), layer_3 = vec4(sum[6].xy, sum[7].xy);
#elif defined(LIT)
    layer_0 = sum[0], layer_1 = vec4(sum[0].x * plane.xyz, 0.0);
    layer_2 = sum[1], layer_3 = vec4(sum[1].x * plane.xyz, 0.0);
#else
    layer_0 = sum[0], layer_1 = sum[1], layer_2 = sum[2], layer_3 = sum[3];
#endif
}
