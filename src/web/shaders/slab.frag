// slab.frag: light of one Gaussian along one pixel's ray, in four depth slabs of the pixel's tile, added up by
// blending (docs/volume_rendering.md): in each the exact part of the integral over |D|, times the expected light at
// the value in the middle of the part. MEANS: eight slabs, two numbers each: the part times the value, and the part.
// Follows chord.glsl.
#ifdef MEANS
const int kSlabs = 8;
#else
const int kSlabs = 4;
#endif
flat in vec3 slope;
flat in vec4 light_at_0, light_at_1, light_at_2;

uniform highp sampler2D ranges;  // of each tile: minus the least depth, the largest
uniform vec2 tile_px;
uniform float slabs, first_slab;
uniform float per_extinction;

layout(location = 0) out vec4 layer_0;
layout(location = 1) out vec4 layer_1;
layout(location = 2) out vec4 layer_2;
layout(location = 3) out vec4 layer_3;

void main() {
    layer_0 = layer_1 = layer_2 = layer_3 = vec4(0.0);
    Chord chord;
    if (!chord_of_pixel(chord)) discard;
    vec2 range = texelFetch(ranges, ivec2((gl_FragCoord.xy + vec2(0.0, first_row)) / tile_px), 0).xy;
    float thickness = (range.x + range.y) / slabs;
    // Ends of the slabs in deviations; beyond the first and the last there is nothing.
    float edge[kSlabs + 1];
    for (int n = 0; n <= kSlabs; ++n) {
        float depth = thickness * (first_slab + float(n)) - range.x;
        edge[n] = clamp((depth - chord.nearest) / chord.deviation, chord.start, chord.end);
    }
    if (first_slab == 0.0) edge[0] = chord.start;
    if (first_slab + float(kSlabs) >= slabs) edge[kSlabs] = chord.end;
    if (edge[0] == edge[kSlabs]) discard;
    float z = dot(slope, chord.at), change = dot(slope, chord.direction) * chord.deviation;
    float before = normal_to(edge[0]);
    vec4 light[kSlabs];
    for (int n = 0; n < kSlabs; ++n) {
        float after = normal_to(edge[n + 1]);
        float at = z + 0.5 * (edge[n] + edge[n + 1]) * change;
        vec4 expected = (light_at_2 * at + light_at_1) * at + light_at_0;
        expected.a = max(expected.a, 0.0);  // colours are limited by it in the end
        light[n] = per_extinction * chord.peak * max(after - before, 0.0) * expected;
        before = after;
    }
#ifdef MEANS
    layer_0 = vec4(light[0].ra, light[1].ra), layer_1 = vec4(light[2].ra, light[3].ra);
    layer_2 = vec4(light[4].ra, light[5].ra), layer_3 = vec4(light[6].ra, light[7].ra);
#else
    layer_0 = light[0], layer_1 = light[1], layer_2 = light[2], layer_3 = light[3];
#endif
}
