// copy.frag: one image added to another by blending.
in vec2 position;

uniform highp sampler2D image;
uniform float first_row;  // of the sums, in the row 0 of the image

layout(location = 0) out vec4 color;

void main() { color = texelFetch(image, ivec2(gl_FragCoord.xy - vec2(0.0, first_row)), 0); }
