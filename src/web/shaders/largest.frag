// largest.frag: largest mean of a field over eight slabs of a pixel, kept by blending (render/splat/volume/slab_maximum.cpp):
// 1, mean. Before that the largest of the slabs' densities. Follows tiles.glsl.
uniform highp sampler2D layer_0, layer_1, layer_2, layer_3;
uniform highp sampler2D densest;  // the largest density
uniform int of_means;             // 0: densities
uniform float least_share;        // of the largest density, below which a mean does not count
uniform float most;               // largest share of the field's range for a density of 1; 0: any
uniform float first_slab;

layout(location = 0) out vec4 color;

float least, per_thickness;

void add_slab(vec2 slab) {
    if (of_means == 0) color.r = max(color.r, slab.x);
    else if (slab.x > 0.0 && slab.x >= least) {
        float mean = slab.y / slab.x;
        if (most > 0.0) mean = min(mean, most * per_thickness * slab.x);
        color = vec4(1.0, max(color.g, clamp(mean, 0.0, 1.0)), 0.0, 0.0);
    }
}

void add(vec4 two) {
    add_slab(two.xy);
    add_slab(two.zw);
}

void main() {
    if (!needs(first_slab, first_slab + 8.0)) discard;
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec2 range = texelFetch(ranges, ivec2(0), 0).xy;
    per_thickness = slabs / (range.x + range.y);  // of a density's part, a unit of depth
    least = of_means == 0 ? 0.0 : least_share * texelFetch(densest, at, 0).r;
    color = vec4(0.0, 0.0, 0.0, 0.0);
    add(texelFetch(layer_0, at, 0));
    add(texelFetch(layer_1, at, 0));
    add(texelFetch(layer_2, at, 0));
    add(texelFetch(layer_3, at, 0));
}
