// color_table.h: Shading on the device: optical depth T to colour by a table over V in [0, 1].
#pragma once

#include "render/device/vector.h"

namespace vog::device {

struct Float4 {
    float x, y, z, w;
};

/// Transfer function: `count` colours at V = 0, 1/(count - 1), ..., 1, linear between them, with
/// straight (not premultiplied) alpha in w.
struct ColorTable {
    const Float4* color;
    int32_t count;
    float extinction;
    Float4 background;
    int32_t blend;  ///< 1: opacity is multiplied by V, the paper's blend
};

/// Porter-Duff `front` over `back`, straight alpha. An opaque back gives mix(back, front, alpha of
/// front), a transparent one gives front unchanged.
VOG_HD Float4 over(Float4 front, Float4 back) {
    const float behind = back.w * (1 - front.w), alpha = front.w + behind;
    if (!(alpha > 0)) return {back.x, back.y, back.z, 0};
    const float f = front.w / alpha, b = behind / alpha;
    return {f * front.x + b * back.x, f * front.y + b * back.y, f * front.z + b * back.z, alpha};
}

/// Colour of a pixel of optical depth T over the background.
VOG_HD Float4 shade(const ColorTable& table, float depth) {
    if (!(depth > 0)) return table.background;
    const float v = -expm1f(-table.extinction * depth);
    const float at = v * static_cast<float>(table.count - 1);
    const int32_t cell = static_cast<int32_t>(fminf(at, static_cast<float>(table.count - 2)));
    const float part = at - static_cast<float>(cell);
    const Float4 a = table.color[cell], b = table.color[cell + 1];
    const Float4 color{a.x + part * (b.x - a.x), a.y + part * (b.y - a.y), a.z + part * (b.z - a.z),
                       a.w + part * (b.w - a.w)};
    return over({color.x, color.y, color.z, table.blend ? color.w * v : color.w}, table.background);
}

}  // namespace vog::device
