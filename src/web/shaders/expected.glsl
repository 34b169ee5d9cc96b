// expected.glsl: mean light of values that are normally distributed, in closed form (render/device/expected_light.h): light
// is linear between the ends of pieces. Values are shares of the field's range. Follows erf.glsl.
uniform highp sampler2D pieces;  // rows of 1024 pieces, three each: ends; light at the first end; at the last
uniform int piece_count;

// Row 0: ends, rows 1 and 2: light.
vec4 piece(int n, int row) { return texelFetch(pieces, ivec2(n % 1024, 3 * (n / 1024) + row), 0); }

int piece_at(float value) {
    int low = 0, high = piece_count - 1;
    while (low < high) {
        int middle = (low + high + 1) / 2;
        if (piece(middle, 0).x <= value) low = middle;
        else high = middle - 1;
    }
    return low;
}

vec4 expected_light(float mean, float deviation) {
    const float kReach = 4.0, kPerRoot2Pi = 0.39894228;
    int n = piece_at(mean - kReach * deviation);
    vec2 ends = piece(n, 0).xy;
    if (!(deviation > 0.0) || (mean + kReach * deviation < ends.y && mean - kReach * deviation >= ends.x))
        return mix(piece(n, 1), piece(n, 2), clamp((mean - ends.x) / (ends.y - ends.x), 0.0, 1.0));
    float z0 = (ends.x - mean) / deviation, below0 = normal_to(z0), density0 = kPerRoot2Pi * exp(-0.5 * z0 * z0), whole = 0.0;
    vec4 sum = vec4(0.0);
    for (; n < piece_count; ++n) {
        ends = piece(n, 0).xy;
        float z1 = (ends.y - mean) / deviation, below1 = normal_to(z1), density1 = kPerRoot2Pi * exp(-0.5 * z1 * z1);
        float mass = below1 - below0, moment;
        if (z1 - z0 < 0.1) {
            // Differences would cancel: the density is nearly linear.
            mass = 0.5 * (density0 + density1) * (z1 - z0);
            moment = mass * 0.5 + (density1 - density0) * (z1 - z0) / 12.0;
        } else {
            moment = ((mean - ends.x) * mass + deviation * (density0 - density1)) / (ends.y - ends.x);
        }
        moment = clamp(moment, 0.0, mass);
        sum += (mass - moment) * piece(n, 1) + moment * piece(n, 2);
        whole += mass;
        if (z1 > kReach) break;
        z0 = z1, below0 = below1, density0 = density1;
    }
    return whole > 0.0 ? sum / whole : vec4(0.0);
}
