// finish.frag: slabs of moments classified and composited front to back (render/device/value_moments.h): premultiplied colour,
// and alpha; blended under what is in front of them. From the last slab of the pass before to the last but one of this pass:
// surfaces are found between a slab and its neighbours. LIT: two slabs a pass, with gradients. Follows erf.glsl, expected.glsl, tiles.glsl.
in vec2 position;

uniform highp sampler2D before_0, before_1, before_2, before_3, layer_0, layer_1, layer_2, layer_3;
uniform highp sampler2D table;  // of table.frag
uniform int exact;              // 1: the closed form: bands are narrower than the table's columns
uniform vec4 columns;           // MeanLight: low, high, per_range, per_part
uniform float unit;             // factor of the light
uniform float parts_per_cell;   // of value_moments.h
uniform float rounding;         // of sums
uniform vec2 size_px, jitter_px;
uniform float pixels_per_unit;
uniform float parallel;         // 1: parallel rays
uniform float asymmetry;        // of the phase function
uniform vec4 lighting;          // ambient, diffuse, specular, power; no surfaces: power 0
uniform vec4 lights[8];         // along right, up and forward; 0: the eye; strength
uniform int light_count;        // 0: all light is ambient
uniform highp sampler3D reached;  // shares of the light from a direction and of ambient light that arrive; opaqueness; light after light along z
uniform float reaches;          // 1: `reached` is there; 0: all light arrives
uniform vec4 reach_light[8];    // xyz: change of its coordinates towards each light
uniform vec3 reach_middle;      // the mean of these
uniform vec2 reach_layers;      // lights in the texture, half a cell along z
uniform vec3 reach_eye, reach_right, reach_up, reach_forward;  // its coordinates at the eye, and their change along the camera's axes
uniform float reach_edge;       // of a cell
uniform vec2 inside;            // of LightLattice, where lights and ambient light are absorbed
uniform float first_slab;       // of before_0
uniform vec4 gradient_part[7];  // GradientFactor: start, width and slope of each
uniform vec4 gradient;          // its number of parts, its first factor, its share by a gradient

layout(location = 0) out vec4 color;

#ifdef LIT
const int kSlabs = 2;
#else
const int kSlabs = 4;
#endif
// NormalPair; rows of MeanLight; steps of a slab from an optical depth on.
const float kShare = 0.95, kMostSkewness = 3.0, kMostVariance = 0.25, kLeastVariance = kMostVariance / 524288.0;
const int kColumns = 1024, kRows = 21, kSteps = 6;
const float kSurfaceDepth = 0.2, kSurfaceShare = 0.5;
const float kTowardsEye = 3.0;  // LightLattice

struct Moments {
    float tau, mean, variance, third;
    vec3 gradient;
};

Moments moments_of(vec4 sum, vec3 gradient) {
    if (!(sum.x > 0.0)) return Moments(0.0, 0.0, 0.0, 0.0, vec3(0.0));
    vec3 m = sum.yzw / sum.x;
    float raw = 1.0 - central;
    return Moments(sum.x, m.x, max(m.y * (1.0 - rounding) - raw * m.x * m.x, 0.0), m.z - raw * m.x * (3.0 * m.y - 2.0 * m.x * m.x), gradient);
}

vec4 table_at(float mean, float row) {
    float x = (mean * columns.z + (clamp(mean, columns.x, columns.y) - columns.x) * columns.w) * float(kColumns - 1);
    ivec2 at = ivec2(min(floor(vec2(x, row)), vec2(kColumns - 2, kRows - 2)));
    vec4 above = mix(texelFetch(table, at, 0), texelFetch(table, at + ivec2(1, 0), 0), x - float(at.x));
    vec4 below = mix(texelFetch(table, at + ivec2(0, 1), 0), texelFetch(table, at + ivec2(1, 1), 0), x - float(at.x));
    return mix(above, below, row - float(at.y));
}

// Of two values side by side in a cell, whose tau is given: seen_share of value_moments.h.
vec4 seen(vec4 low, vec4 high, float share, float cell) {
    float mean = cell * mix(low.a, high.a, share);
    float passed = mix(exp(-cell * low.a), exp(-cell * high.a), share);
    return (mean > 0.02 ? -log(max(passed, 1e-30)) / mean : 1.0) * mix(low, high, share);
}

// Light per unit of tau.
vec4 normal_light(float mean, float variance) {
    if (exact == 1) return expected_light(mean, sqrt(variance));
    // The bits of a float above a power of two count octaves, linear between them.
    return table_at(mean, variance <= kLeastVariance ? variance / kLeastVariance
                        : 1.0 + float(floatBitsToInt(min(variance, kMostVariance)) - floatBitsToInt(kLeastVariance)) / 8388608.0);
}

// Gradient opacity: render/device/gradient_factor.h.
float gradient_factor(Moments m) {
    float share = gradient.z * length(m.gradient) / m.tau, factor = gradient.y;
    for (int n = 0; n < int(gradient.x); ++n) factor += clamp(share - gradient_part[n].x, 0.0, gradient_part[n].y) * gradient_part[n].z;
    return gradient.x > 0.0 ? clamp(factor, 0.0, 1.0) : 1.0;
}

vec4 mean_light(Moments m, float slant) {
    float factor = gradient_factor(m), cell = factor * unit * m.tau * slant * parts_per_cell;
    if (!(m.variance > max(1e-5, 25.0 * rounding))) {
        vec4 one = normal_light(clamp(m.mean, 0.0, 1.0), m.variance);
        return factor * seen(one, one, 0.5, cell);
    }
    float deviation = sqrt(m.variance);
    float u = clamp(m.third / (m.variance * deviation), -kMostSkewness, kMostSkewness) / (kShare * kShare * kShare);
    float root = sqrt(u * u + 4.0);
    vec2 means = clamp(m.mean + 0.5 * kShare * deviation * vec2(u + root, u - root), 0.0, 1.0), room = min(means, 1.0 - means);
    vec2 variance = min(vec2((1.0 - kShare * kShare) * m.variance), room * room);
    return factor * seen(normal_light(means.y, variance.y), normal_light(means.x, variance.x), 0.5 * (1.0 - u / root), cell);
}

// LightLattice of render/device/light/light_lattice.h, where a slab or one of its parts is seen: seen_at of value_moments.h.
vec3 reached_at(float depth, vec3 along) {
    vec2 side = parallel == 1.0 ? along.xy : depth * along.xy;
    return reach_eye + depth * reach_forward + side.x * reach_right + side.y * reach_up;
}
// xyz: place towards the eye; w: how far a light is looked up from there towards it.
vec4 reached_in(float slab, float parts, float seen, vec3 along) {
    if (reaches == 0.0) return vec4(0.0);
    slab += ((seen < 0.1 ? 0.5 - seen / 12.0 : 1.0 / seen - 1.0 / (exp(min(seen, 80.0)) - 1.0)) - 0.5) / parts;
    vec2 range = texelFetch(ranges, ivec2(0), 0).xy;
    float depth = (range.x + range.y) / slabs * (slab + 0.5) - range.x;
    float opaque = textureLod(reached, reached_at(depth, along), 0.0).z, towards_eye = kTowardsEye * reach_edge / (parallel == 1.0 ? 1.0 : length(along));
    return vec4(reached_at(depth - opaque * towards_eye, along), opaque);
}
vec2 shares_at(vec4 place, vec3 towards, int light) {
    if (reaches == 0.0) return vec2(1.0);
    vec3 at = place.xyz + place.w * towards;
    at.z = (clamp(at.z, reach_layers.y, 1.0 - reach_layers.y) + float(light)) / reach_layers.x;
    return textureLod(reached, at, 0.0).xy;
}

// Blinn and Phong's shading (render/device/light/shading.h), along the camera's axes; at most what is absorbed.
vec4 shaded(vec4 light, vec3 gradient, vec3 towards_eye, vec4 place) {
    float steepness = length(gradient), whole = lighting.x + lighting.y, g = asymmetry;
    bool surface = lighting.w > 0.0 && steepness > 0.0;
    if (!surface && (reaches + lighting.w == 0.0 || !(whole > 0.0))) return light;
    vec3 normal = surface ? gradient / steepness : vec3(0.0);
    if (dot(normal, towards_eye) < 0.0) normal = -normal;
    vec2 left = 1.0 / (1.0 + place.w * inside), first = shares_at(place, reach_light[0].xyz, 0);
    float body = lighting.x * left.y * (light_count > 1 ? shares_at(place, reach_middle, 0).y : first.y), shine = 0.0;
    for (int n = 0; n < light_count; ++n) {
        vec3 to = dot(lights[n].xyz, lights[n].xyz) > 0.0 ? lights[n].xyz : towards_eye, between = to + towards_eye;
        float direct = lights[n].w * left.x * (n == 0 ? first.x : shares_at(place, reach_light[n].xyz, n).x), facing = dot(normal, to);
        if (!surface) body += direct * lighting.y * (1.0 - g * g) * pow(1.0 + g * g + 2.0 * g * dot(to, towards_eye), -1.5);  // the phase function
        if (!(facing > 0.0)) continue;
        float mirrored = clamp(dot(normal, between) / length(between), 0.0, 1.0);
        body += direct * lighting.y * facing;
        if (mirrored > 0.0) shine += direct * lighting.z * pow(mirrored, lighting.w);
    }
    if (!surface) body /= whole;
    return vec4(min(body * light.rgb + shine * light.a, light.a), light.a);
}

void composite(vec4 light, float tau) {
    float depth = light.a * tau;
    if (!(depth > 0.0)) return;
    float passed = exp(-depth);
    float share = depth < 0.06 ? ((-depth / 24.0 + 1.0 / 6.0) * depth - 0.5) * depth + 1.0 : (1.0 - passed) / depth;
    color.rgb += (1.0 - color.a) * share * tau * light.rgb;
    color.a = 1.0 - (1.0 - color.a) * passed;
}

// Variance in a slab of means that change linearly from slab to slab; towards one with less tau by its share.
float trend_between(Moments own, Moments other) {
    float change = min(other.tau / own.tau, 1.0) * (other.mean - own.mean);
    return change * change / 12.0;
}

// Between the means of slabs weights, means and spreads are linear; less the trend.
Moments step_between(Moments own, Moments other, float division, float at) {
    float share = division * at, rest = 1.0 - share, beside = other.tau * share, tau = own.tau * rest + beside, of = beside / tau;
    return Moments(tau, mix(own.mean, other.mean, of), max(mix(own.variance, other.variance, of) - division * division * trend_between(own, other), 0.0),
                   mix(own.third, other.third, of), share * other.gradient + rest * own.gradient);
}

// along  the slope of the ray, or the place of a parallel one; forward 1
void add_slab(float slab, Moments own, Moments before, Moments behind, vec3 along, vec3 towards_eye, float slant) {
    if (!(own.tau > 0.0)) return;
    vec4 mean = mean_light(own, slant);
    vec4 light = unit * shaded(mean, own.gradient, towards_eye, reached_in(slab, 1.0, unit * mean.a * own.tau * slant, along));
#ifdef LIT
    float sloped = 2.0;  // by depth alone: normals change where means do not
#else
    float sloped = max(trend_between(own, before), trend_between(own, behind)) / max(kSurfaceShare * own.variance, 1e-12);
#endif
    float division = min(min(light.a * own.tau * slant / kSurfaceDepth, sloped) - 1.0, 1.0);
    if (!(division > 0.0)) {
        composite(light, own.tau * slant);
        return;
    }
    // Steps together have the slab's weight and mean.
    Moments steps[kSteps];
    float whole = 0.0, first = 0.0;
    for (int k = 0; k < kSteps; ++k) {
        float at = (float(k) + 0.5) / float(kSteps) - 0.5;
        if (at < 0.0) steps[k] = step_between(own, before, division, -at);
        else steps[k] = step_between(own, behind, division, at);
        whole += steps[k].tau, first += steps[k].tau * steps[k].mean;
    }
    for (int k = 0; k < kSteps; ++k) {
        Moments m = steps[k];
        m.mean += own.mean - first / whole, m.tau *= own.tau / whole;
        if (gradient.x > 0.0) m.gradient *= own.tau / whole;
        float of_slab = slab + (float(k) + 0.5) / float(kSteps) - 0.5;
        mean = mean_light(m, float(kSteps) * slant);
        composite(unit * shaded(mean, m.gradient, towards_eye, reached_in(of_slab, float(kSteps), unit * mean.a * m.tau * slant, along)), m.tau * slant);
    }
}

void main() {
    if (!needs(first_slab + float(kSlabs - 1), first_slab + float(2 * kSlabs - 1))) discard;
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec2 slope = (gl_FragCoord.xy + vec2(0.0, first_row) - 0.5 * size_px + jitter_px) / pixels_per_unit * vec2(1.0, -1.0);
    vec3 along = vec3((1.0 - parallel) * slope, 1.0);
    float slant = length(along);
    Moments slab[2 * kSlabs];
#ifdef LIT
    slab[0] = moments_of(texelFetch(before_0, at, 0), texelFetch(before_1, at, 0).xyz);
    slab[1] = moments_of(texelFetch(before_2, at, 0), texelFetch(before_3, at, 0).xyz);
    slab[2] = moments_of(texelFetch(layer_0, at, 0), texelFetch(layer_1, at, 0).xyz);
    slab[3] = moments_of(texelFetch(layer_2, at, 0), texelFetch(layer_3, at, 0).xyz);
#else
    slab[0] = slab[1] = moments_of(vec4(0.0), vec3(0.0));
    slab[2] = moments_of(texelFetch(before_2, at, 0), vec3(0.0)), slab[3] = moments_of(texelFetch(before_3, at, 0), vec3(0.0));
    slab[4] = moments_of(texelFetch(layer_0, at, 0), vec3(0.0)), slab[5] = moments_of(texelFetch(layer_1, at, 0), vec3(0.0));
    slab[6] = moments_of(texelFetch(layer_2, at, 0), vec3(0.0)), slab[7] = moments_of(texelFetch(layer_3, at, 0), vec3(0.0));
#endif
    color = vec4(0.0);
    for (int n = kSlabs - 1; n < 2 * kSlabs - 1; ++n)
        add_slab(first_slab + float(n), slab[n], slab[n - 1], slab[n + 1], vec3(slope, 1.0), -along / slant, slant);
}
