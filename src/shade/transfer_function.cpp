// transfer_function.cpp: evaluation of a transfer function at one V, and its validation.
#include <fmt/core.h>

#include "shade/ramp.h"
#include "shade/transfer_function.h"
#include "vog/error.h"

namespace vog {

using namespace shading;

namespace {

void require_points(const std::string& where, const char* what, const auto& points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        bool valid = in_unit_range(points[i].v);
        for (const float c : components(points[i])) valid = valid && in_unit_range(c);
        if (!valid)
            throw Error(fmt::format("{}: {} point {}: expected numbers in [0, 1]", where, what, i));
        if (i > 0 && points[i].v < points[i - 1].v)
            throw Error(fmt::format("{}: {} point {}: v = {} after {}, expected sorted points",
                                    where, what, i, points[i].v, points[i - 1].v));
    }
}

}  // namespace

void shading::require_valid(const std::string& where, const TransferFunction& tf) {
    if (tf.color.empty()) throw Error(fmt::format("{}: no colour, expected at least one", where));
    require_points(where, "colour", tf.color);
    require_points(where, "opacity", tf.opacity);
}

std::vector<ColorPoint> shading::colors_from(const std::vector<ColorPoint>& colors, float first) {
    const auto [r, g, b] = Ramp<3>(colors)(first);
    std::vector<ColorPoint> rest{{0, r, g, b}};
    for (ColorPoint point : colors) {
        if (point.v <= first) continue;
        point.v = (point.v - first) / (1 - first);
        rest.push_back(point);
    }
    return rest;
}

TransferFunction fading(const TransferFunction& tf) {
    require_valid("transfer function " + tf.name, tf);
    constexpr int kSteps = 64;
    constexpr float kLuma = 0.2f;
    const Ramp<3> color(tf.color);
    for (int n = 0; n <= kSteps / 2; ++n) {
        const float v = static_cast<float>(n) / kSteps;
        const auto [r, g, b] = color(v);
        if (0.2126f * r + 0.7152f * g + 0.0722f * b < kLuma) continue;
        return n == 0 ? tf : TransferFunction{tf.name, colors_from(tf.color, v), tf.opacity};
    }
    return tf;
}

Rgba color_at(const TransferFunction& tf, float v) {
    require_valid("transfer function " + tf.name, tf);
    if (!in_unit_range(v))
        throw Error(fmt::format("transfer function {} at V = {}, expected [0, 1]", tf.name, v));
    const auto [r, g, b] = Ramp<3>(tf.color)(v);
    const auto [opacity] = Ramp<1>(tf.opacity.empty() ? kOpaque : tf.opacity)(v);
    return {r, g, b, opacity};
}

}  // namespace vog
