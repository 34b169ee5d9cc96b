// table.frag: the table of mean light that finish.frag reads, a column a mean and a row a variance. Follows expected.glsl.
uniform vec4 columns;  // as finish.frag has them

layout(location = 0) out vec4 color;

void main() {
    float at = (gl_FragCoord.x - 0.5) / 1023.0, low = columns.x * columns.z;
    float high = columns.y * columns.z + (columns.y - columns.x) * columns.w;
    float mean = at <= low ? 2.0 * at : at >= high ? 1.0 - 2.0 * (1.0 - at) : mix(columns.x, columns.y, (at - low) / (high - low));
    float row = floor(gl_FragCoord.y);
    color = expected_light(clamp(mean, 0.0, 1.0), row == 0.0 ? 0.0 : 0.5 * exp2(0.5 * (row - 20.0)));
}
