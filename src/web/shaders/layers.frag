// layers.frag: four slabs of light composited front to back: premultiplied colour, and alpha; blended under what is
// in front of them.
in vec2 position;

uniform highp sampler2D layer_0, layer_1, layer_2, layer_3;
uniform vec2 size_px, jitter_px;
uniform float first_row;        // of the image, in the target's row 0
uniform float pixels_per_unit;
uniform float parallel;         // 1: parallel rays

layout(location = 0) out vec4 color;

void add(vec4 light, float slant) {
    float depth = light.a * slant;
    if (!(depth > 0.0)) return;
    float passed = exp(-depth);
    float share = depth < 0.06 ? ((-depth / 24.0 + 1.0 / 6.0) * depth - 0.5) * depth + 1.0 : (1.0 - passed) / depth;
    // Quadratics are fitted one by one: light is at most all that is absorbed.
    color.rgb += (1.0 - color.a) * share * slant * clamp(light.rgb, 0.0, light.a);
    color.a = 1.0 - (1.0 - color.a) * passed;
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec2 slope = (gl_FragCoord.xy + vec2(0.0, first_row) - 0.5 * size_px + jitter_px) / pixels_per_unit;
    float slant = sqrt(1.0 + (1.0 - parallel) * dot(slope, slope));
    color = vec4(0.0);
    add(texelFetch(layer_0, at, 0), slant);
    add(texelFetch(layer_1, at, 0), slant);
    add(texelFetch(layer_2, at, 0), slant);
    add(texelFetch(layer_3, at, 0), slant);
}
