// tiles.glsl: which slabs a pixel needs: those that Gaussians above its tile of 16 x 16 pixels meet.
uniform highp sampler2D ranges, tiles;  // of all depths, and of those above each tile: minus the least, the largest
uniform float slabs;                    // of the picture
uniform float first_row;                // of the image, in the target's row 0
uniform float central;                  // 1: sums are half floats

/// Whether something lies between two ends, in slabs.
bool needs(float first, float last) {
    vec2 all = texelFetch(ranges, ivec2(0), 0).xy, own = texelFetch(tiles, ivec2(gl_FragCoord.xy + vec2(0.0, first_row)) / 16, 0).xy;
    float per_depth = slabs / (all.x + all.y), slack = 0.001 + 0.001 * central * per_depth * max(abs(own.x), abs(own.y));
    return (own.y + all.x) * per_depth > first - slack && (all.x - own.x) * per_depth < last + slack;
}
