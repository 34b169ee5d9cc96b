// look.cpp: map, range, gamma, inversion and opacity points to one transfer function.
#include "quantity/look.h"

#include <algorithm>
#include <cmath>

namespace vog::viewer {

void load_map(Look& look, const std::string& name_or_file) {
    look.base = load_transfer_function(name_or_file);
    look.map = name_or_file;
    // Named maps have no opacity: the look keeps its own.
    if (!look.base.opacity.empty()) look.opacity = look.base.opacity;
}

TransferFunction transfer_function(const Look& look) {
    TransferFunction tf{look.base.name, {}, look.opacity};
    std::vector<ColorPoint> colors = look.base.color;
    if (look.invert) {
        std::reverse(colors.begin(), colors.end());
        for (ColorPoint& c : colors) c.v = 1 - c.v;
    }
    const auto place = [&](float s) {
        const float v = std::pow(std::clamp(s, 0.0f, 1.0f), 1 / look.gamma);
        return std::clamp(look.low + v * (look.high - look.low), 0.0f, 1.0f);
    };
    for (std::size_t i = 0; i < colors.size(); ++i) {
        const ColorPoint& b = colors[i];
        if (i > 0 && look.gamma != 1 && b.v > colors[i - 1].v) {
            // Pieces of equal length along V or along the map, whichever the curve is flatter in:
            // at most 1/200 each.
            const ColorPoint& a = colors[i - 1];
            const float power = std::max(1.0f, look.gamma);
            const int pieces = 4 + static_cast<int>(200 * (b.v - a.v));
            for (int n = 1; n < pieces; ++n) {
                const float share = static_cast<float>(n) / static_cast<float>(pieces);
                const float s = std::pow(
                    std::lerp(std::pow(a.v, 1 / power), std::pow(b.v, 1 / power), share), power);
                const float t = std::clamp((s - a.v) / (b.v - a.v), 0.0f, 1.0f);
                const float at = std::max(place(s), tf.color.back().v);
                tf.color.push_back(
                    {at, std::lerp(a.r, b.r, t), std::lerp(a.g, b.g, t), std::lerp(a.b, b.b, t)});
            }
        }
        const float at = place(b.v);
        tf.color.push_back(
            {tf.color.empty() ? at : std::max(at, tf.color.back().v), b.r, b.g, b.b});
    }
    return tf;
}

TransferFunction map_function(const Look& look) {
    Look whole = look;
    whole.low = 0, whole.high = 1;
    whole.opacity = look.base.opacity;
    return transfer_function(whole);
}

}  // namespace vog::viewer
