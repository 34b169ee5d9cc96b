// screen.vert: one triangle that covers the viewport.
out vec2 position;  // [0, 1], (0, 0) the top left

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
    gl_Position = vec4(corner, 0.0, 1.0);
    position = vec2(0.5 + 0.5 * corner.x, 0.5 - 0.5 * corner.y);
}
