// shade.cpp: colours of a depth image: V = 1 - exp(-T), transfer function, background.
#include "vog/shade.h"

#include <fmt/core.h>
#include <tbb/blocked_range.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "core/parallel.h"
#include "data/image_checks.h"
#include "shade/ramp.h"
#include "shade/transfer_function.h"
#include "vog/error.h"
#include "vog/quantity.h"

namespace vog {

using namespace shading;
namespace {

/// Porter-Duff `front` over `back` with straight alpha: mix(back, front, front.a) for an opaque
/// back, `front` unchanged for a transparent one.
Rgba over(const Rgba& front, const Rgba& back) {
    if (front.a == 1) return front;
    const float behind = back.a * (1 - front.a);
    const float alpha = front.a + behind;
    if (alpha <= 0) return {back.r, back.g, back.b, 0};
    const float f = back.a == 1 ? front.a : front.a / alpha;
    const float b = back.a == 1 ? 1 - front.a : behind / alpha;
    return {f * front.r + b * back.r, f * front.g + b * back.g, f * front.b + b * back.b,
            back.a == 1 ? 1 : alpha};
}

/// Shades by position(value), [0, 1], the pixels of which shows(value) is true, with opacity times weight(position).
template <class Shows, class Position, class Weight>
Image shade_by(int width, int height, std::span<const float> values, const TransferFunction& tf,
               const ShadeOptions& options, const Shows& shows, const Position& position,
               const Weight& weight) {
    require_valid("transfer function " + tf.name, tf);
    const Rgba& background = options.background;
    for (const float c : {background.r, background.g, background.b, background.a})
        if (!in_unit_range(c))
            throw Error(fmt::format("background ({}, {}, {}, {}), expected numbers in [0, 1]",
                                    background.r, background.g, background.b, background.a));

    const bool opaque = tf.opacity.empty();
    const Ramp<3> color(tf.color);
    const Ramp<1> opacity(opaque ? kOpaque : tf.opacity);
    Image image(width, height);
    vog::parallel_for(tbb::blocked_range<std::size_t>(0, values.size(), 1 << 14),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i) {
                              const float t = values[i];
                              if (!shows(t)) {
                                  image.pixel[i] = background;
                                  continue;
                              }
                              const float v = position(t);
                              const auto [r, g, b] = color(v);
                              const float a = (opaque ? 1 : opacity(v)[0]) * weight(v);
                              image.pixel[i] = over({r, g, b, a}, background);
                          }
                      });
    return image;
}

bool is_positive(float value) { return value > 0; }
float whole(float) { return 1; }

/// throws vog::Error for options or a scale that do not go with values
void check_values(const ColorScale& scale, const ShadeOptions& options) {
    if (options.blend)
        throw Error("blend: fades by V = 1 - exp(-T), which a map of values does not have");
    (void)scale_position(scale, 0);  // checks the scale
}

}  // namespace

Image shade(const DepthImage& depth, const TransferFunction& tf, const ShadeOptions& options) {
    require_valid("shade", depth);
    return shade_by(
        depth.width, depth.height, depth.depth, options.blend ? fading(tf) : tf, options,
        is_positive, [](float t) { return 1 - std::exp(-t); },
        [&](float v) { return options.blend ? v : std::min(v / kRim, 1.0f); });
}

Image shade_values(const DepthImage& values, const TransferFunction& tf, const ColorScale& scale,
                   const ShadeOptions& options) {
    check_values(scale, options);
    require_valid("shade", values);
    return shade_by(
        values.width, values.height, values.depth, tf, options, is_positive,
        [&](float value) { return static_cast<float>(scale_position(scale, double{value})); },
        whole);
}

Image shade_map(const ValueMap& map, const TransferFunction& tf, const ColorScale& scale,
                const ShadeOptions& options) {
    check_values(scale, options);
    require_valid_size("shade", map.width, map.height);
    return shade_by(
        map.width, map.height, map.value, tf, options,
        [](float value) { return !std::isnan(value); },
        [&](float value) {
            if (double{value} < scale.low) return -1.0f;
            return static_cast<float>(scale_position(scale, double{value}));
        },
        whole);
}

}  // namespace vog
