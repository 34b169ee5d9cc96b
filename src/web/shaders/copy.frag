// copy.frag: one image added to another by blending. MEANS: of largest.frag, as sums of a field of column 1. OPAQUE: only pixels that are.
in vec2 position;

uniform highp sampler2D image;
uniform float first_row;  // of the sums, in the row 0 of the image

#ifdef OPAQUE
uniform float opaque;
#endif

layout(location = 0) out vec4 color;

void main() {
    color = texelFetch(image, ivec2(gl_FragCoord.xy - vec2(0.0, first_row)), 0);
#ifdef OPAQUE
    if (color.a < opaque) discard;
#endif
#ifdef MEANS
    float value = 2.0 * color.g - 1.0;  // the field's range is -1 to 1
    color = color.r > 0.0 ? vec4(1.0, value, value * value, 0.0) : vec4(0.0);
#endif
}
