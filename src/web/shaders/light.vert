// light.vert: quadratics of each Gaussian's expected light under a transfer function of values (fit_light of
// render/by_value/value_light.h), one point a Gaussian, to images that splat.vert reads. Values are in units of the
// table: the data's range is -1 to 1.
layout(location = 3) in vec4 field_plane;  // value at the mean, its change over a standard deviation along each own axis
layout(location = 4) in vec2 field_rest;   // deviation and skewness of the residual

uniform highp sampler2D table;      // expected light of one normal distribution: columns of values, rows of deviations
uniform vec4 part;                  // ends of the part of the range with half of the columns; shares of them a unit of both
uniform vec2 image_px;              // size of the images
uniform int planes;                 // 1: the plane of the field in red and alpha 1, in place of light

flat out vec4 power_0, power_1, power_2;

const int kWidth = 1024;
const float kShare = 0.95;          // of the deviation, between the two normal distributions

// Share of the table's columns up to a value: half over the range, half over the part where the transfer function changes.
float column_of(float value) { return (value + 1.0) * part.z + (clamp(value, part.x, part.y) - part.x) * part.w; }

vec4 expected(float value, float row) {
    ivec2 size = textureSize(table, 0);
    float x = column_of(clamp(value, -1.0, 1.0)) * float(size.x - 1), left = min(floor(x), float(size.x - 2));
    float top = min(floor(row), float(size.y - 2));
    ivec2 at = ivec2(left, top);
    vec4 above = mix(texelFetch(table, at, 0), texelFetch(table, at + ivec2(1, 0), 0), x - left);
    vec4 below = mix(texelFetch(table, at + ivec2(0, 1), 0), texelFetch(table, at + ivec2(1, 1), 0), x - left);
    return mix(above, below, row - top);
}

void main() {
    vec2 texel = vec2(gl_VertexID % kWidth, gl_VertexID / kWidth) + 0.5;
    gl_Position = vec4(texel / image_px * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
    float deviation = field_rest.x, spread = length(field_plane.yzw);
    if (planes == 1) {
        power_0 = vec4(field_plane.x, 0.0, 0.0, 1.0), power_1 = vec4(spread, 0.0, 0.0, 0.0), power_2 = vec4(0.0);
        return;
    }
    float u = field_rest.y / (kShare * kShare * kShare), root = sqrt(u * u + 4.0);
    float high = 0.5 * (u + root), low = 0.5 * (u - root), weight = -low / root;
    vec2 offset = deviation * kShare * vec2(high, low);
    // Rows are cubes of their share of the largest deviation, 1.
    float row = pow(min(deviation * sqrt(1.0 - kShare * kShare), 1.0), 1.0 / 3.0) *
                float(textureSize(table, 0).y - 1);
    // Least squares over z, weighted by a normal distribution: odd moments vanish.
    vec4 b0 = vec4(0.0), b1 = vec4(0.0), b2 = vec4(0.0);
    float m0 = 0.0, m2 = 0.0, m4 = 0.0;
    bool constant = !(spread > 2e-6);
    for (int n = -4; n <= 4; ++n) {
        float z = 0.5 * float(n), w = exp(-0.5 * z * z), mean = field_plane.x + (constant ? 0.0 : z * spread);
        if (constant && n != 0) continue;
        vec4 light = weight * expected(mean + offset.x, row) + (1.0 - weight) * expected(mean + offset.y, row);
        b0 += w * light, b1 += w * z * light, b2 += w * z * z * light;
        m0 += w, m2 += w * z * z, m4 += w * z * z * z * z;
    }
    power_0 = b0, power_1 = power_2 = vec4(0.0);
    if (!constant) {
        float per_det = 1.0 / (m0 * m4 - m2 * m2);
        power_0 = (b0 * m4 - b2 * m2) * per_det;
        power_1 = b1 / m2;
        power_2 = (b2 * m0 - b0 * m2) * per_det;
    }
}
