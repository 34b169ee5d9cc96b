// gui.frag: the font's texture, tinted.
in vec2 texture_at;
in vec4 vertex_tint;

uniform sampler2D image;

layout(location = 0) out vec4 color;

void main() { color = vertex_tint * texture(image, texture_at); }
