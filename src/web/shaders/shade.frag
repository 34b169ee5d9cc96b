// shade.frag: colour of T as in vog::shade: V = 1 - exp(-T), transfer function for T > 0, background
// elsewhere; of a column, a field's mean or deviation over a scale; or colours themselves, premultiplied. Image A
// left of the split line and B right of it, or their difference.
in vec2 position;

// T, one channel; or column, column times mean, column times mean square of a field; or colours.
uniform highp sampler2D depth_a, depth_b;
uniform int quantity;       // 0: T, 1: column, 2: mean, 3: deviation, 4: colours
uniform vec2 scale_ends;    // values of the first and the last colour
uniform bool log_scale;
uniform vec2 field_unit;    // value 0 of the sums, and their unit
uniform float least_column; // below which a field has no colour
uniform vec2 size_a, size_b;               // pixels
uniform float factor_a, factor_b;          // extinction / number of sub-frames
uniform highp sampler2D transfer;          // one row: colour and opacity at sqrt(V) = 0 ... 1
uniform float transfer_size;
uniform vec4 background;
uniform bool blend;
uniform bool checker;       // chequered pattern behind transparent pixels
uniform float split;        // share of the width, [0, 1]; from 1 on: A only
uniform bool difference;
uniform float difference_limit;  // at the ends of its colours: |V - V'|, a share of the scale, a difference of colours
uniform vec2 viewport_px, viewport_origin_px;

layout(location = 0) out vec4 color;

// Sums at this fragment: the pixel itself if image and viewport have the same size, else bilinear.
vec4 sums_at(highp sampler2D image, vec2 size) {
    ivec2 last = ivec2(size) - 1;
    vec2 at = position * size - 0.5;
    if (size == viewport_px) {
        vec2 pixel = gl_FragCoord.xy - viewport_origin_px;
        pixel.y = viewport_px.y - pixel.y;  // rows of T run from the top
        return texelFetch(image, clamp(ivec2(floor(pixel)), ivec2(0), last), 0);
    }
    ivec2 base = ivec2(floor(at));
    vec2 f = at - vec2(base);
    ivec2 low = clamp(base, ivec2(0), last), high = clamp(base + 1, ivec2(0), last);
    return mix(mix(texelFetch(image, low, 0), texelFetch(image, ivec2(high.x, low.y), 0), f.x),
               mix(texelFetch(image, ivec2(low.x, high.y), 0), texelFetch(image, high, 0), f.x), f.y);
}

vec4 transfer_at(float v) {
    float at = sqrt(v) * (transfer_size - 1.0), base = floor(at);
    vec4 low = texelFetch(transfer, ivec2(int(base), 0), 0);
    vec4 high = texelFetch(transfer, ivec2(int(min(base + 1.0, transfer_size - 1.0)), 0), 0);
    return mix(low, high, at - base);  // linear in sqrt(V), close to linear in V between neighbours
}

// Front over back with straight alpha, as in vog::shade.
vec4 over(vec4 front, vec4 back) {
    float behind = back.a * (1.0 - front.a), alpha = front.a + behind;
    if (alpha <= 0.0) return vec4(back.rgb, 0.0);
    return vec4((front.a * front.rgb + behind * back.rgb) / alpha, alpha);
}

// Blue: V of A below that of B, red: above, grey: equal, as in vog compare --diff.
vec4 difference_color(float signed_share) {
    float s = clamp(signed_share, -1.0, 1.0);
    vec3 grey = vec3(0.8667), end = s < 0.0 ? vec3(0.231, 0.298, 0.753) : vec3(0.706, 0.016, 0.149);
    return vec4(mix(grey, end, abs(s)), 1.0);
}

// Position of a value among the colours, [0, 1].
float scaled(float value) {
    float at = log_scale ? log(max(value, 1e-37) / scale_ends.x) / log(scale_ends.y / scale_ends.x)
                         : (value - scale_ends.x) / (scale_ends.y - scale_ends.x);
    return clamp(at, 0.0, 1.0);
}

// The shown value of a column and a field.
float shown_value(vec4 sums, float column) {
    float mean = sums.g / sums.r;
    if (quantity == 2) return field_unit.x + field_unit.y * mean;
    if (quantity == 3) return field_unit.y * sqrt(max(sums.b / sums.r - mean * mean, 0.0));
    return column;
}

// Colour of the sums of a field, or of colours that add up to a picture.
vec4 shown(vec4 sums, float factor) {
    if (quantity == 4) {
        vec4 front = sums * factor;
        if (front.a > 0.0) front.rgb /= front.a;
        return over(clamp(front, 0.0, 1.0), background);
    }
    float column = sums.r * factor;
    if (!(column > (quantity == 1 ? 0.0 : least_column))) return background;
    return over(transfer_at(scaled(shown_value(sums, column))), background);
}

// Colour of T.
vec4 visible(float t) {
    if (!(t > 0.0)) return background;
    float v = 1.0 - exp(-t);
    vec4 front = transfer_at(v);
    front.a *= blend ? v : min(v / 0.05, 1.0);  // kRim
    return over(front, background);
}

// What a difference compares: V, a share of the scale beyond its ends too, the mean of three colours; and whether
// there is any.
vec2 compared(vec4 sums, float factor) {
    if (quantity == 0) return vec2(-exp(-sums.r * factor), 1.0);
    if (quantity == 4) return vec2(dot(shown(sums, factor).rgb, vec3(1.0 / 3.0)), 1.0);
    float column = sums.r * factor;
    if (!(column > (quantity == 1 ? 0.0 : least_column))) return vec2(0.0);
    float value = shown_value(sums, column);
    return vec2(log_scale ? log(max(value, 1e-37) / scale_ends.x) / log(scale_ends.y / scale_ends.x)
                          : (value - scale_ends.x) / (scale_ends.y - scale_ends.x), 1.0);
}

void main() {
    bool left = position.x < split;
    vec4 a = sums_at(depth_a, size_a);
    if (difference) {
        vec2 of_a = compared(a, factor_a), of_b = compared(sums_at(depth_b, size_b), factor_b);
        color = of_a.y * of_b.y > 0.0 ? difference_color((of_a.x - of_b.x) / difference_limit) : background;
        return;
    }
    vec4 sums = left ? a : sums_at(depth_b, size_b);
    float factor = left ? factor_a : factor_b;
    color = quantity == 0 ? visible(sums.r * factor) : shown(sums, factor);
    if (checker && color.a < 1.0) {
        vec2 cell = floor((gl_FragCoord.xy - viewport_origin_px) / 12.0);
        vec3 board = vec3(mod(cell.x + cell.y, 2.0) < 1.0 ? 0.30 : 0.36);
        color = vec4(mix(board, color.rgb, color.a), 1.0);
    }
}
