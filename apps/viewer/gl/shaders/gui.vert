// gui.vert: Dear ImGui's triangles, in its coordinates.
layout(location = 0) in vec2 at;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 tint;

uniform vec4 window;  // left, top, width, height

out vec2 texture_at;
out vec4 vertex_tint;

void main() {
    texture_at = uv;
    vertex_tint = tint;
    vec2 unit = (at - window.xy) / window.zw;
    gl_Position = vec4(2.0 * unit.x - 1.0, 1.0 - 2.0 * unit.y, 0.0, 1.0);
}
