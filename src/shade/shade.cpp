// shade.cpp: transfer functions evaluated, one pixel or a picture at a time.
#include "vog/shade.h"

#include <fmt/core.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "io/image_files.h"
#include "shade/transfer_function.h"
#include "vog/error.h"

namespace vog {
namespace {

bool in_unit_range(float x) { return x >= 0 && x <= 1; }  // false for NaN

std::array<float, 3> components(const ColorPoint& point) { return {point.r, point.g, point.b}; }
std::array<float, 1> components(const OpacityPoint& point) { return {point.opacity}; }

/// A piecewise linear function of v, evaluated in constant time: v in [0, 1] falls into one of 1024
/// equal buckets, which knows the first piece it meets. Exact: buckets only start the search.
template <std::size_t N>
class Ramp {
  public:
    template <class Point>
    explicit Ramp(const std::vector<Point>& points) {
        // A constant before the first point, a line between two, a constant after the last.
        constexpr float kInfinity = std::numeric_limits<float>::infinity();
        pieces_.push_back({points.front().v, 0, components(points.front()), {}});
        for (std::size_t i = 1; i < points.size(); ++i) {
            const float v0 = points[i - 1].v, width = points[i].v - v0;
            if (width < std::numeric_limits<float>::min()) continue;  // a step
            const std::array<float, N> from = components(points[i - 1]), to = components(points[i]);
            std::array<float, N> slope;
            for (std::size_t c = 0; c < N; ++c) slope[c] = (to[c] - from[c]) / width;
            pieces_.push_back({points[i].v, v0, from, slope});
        }
        pieces_.push_back({kInfinity, 0, components(points.back()), {}});

        std::uint32_t piece = 0;
        for (std::size_t b = 0; b < kBuckets; ++b) {
            while (static_cast<float>(b) / kBuckets >= pieces_[piece].end) ++piece;
            first_[b] = piece;
        }
    }

    /// v in [0, 1]
    std::array<float, N> operator()(float v) const {
        const auto bucket = static_cast<std::uint32_t>(v * kBuckets);
        const Piece* piece = &pieces_[first_[std::min(bucket, kBuckets - 1)]];
        while (v >= piece->end) ++piece;
        std::array<float, N> value = piece->value;
        for (std::size_t c = 0; c < N; ++c) value[c] += (v - piece->start) * piece->slope[c];
        return value;
    }

  private:
    static constexpr std::uint32_t kBuckets = 1024;  // a power of two: bucket edges are exact
    struct Piece {
        float end, start;
        std::array<float, N> value, slope;  ///< value at `start`, and its change per v
    };
    std::vector<Piece> pieces_;
    std::array<std::uint32_t, kBuckets> first_{};
};

const std::vector<OpacityPoint> kOpaque{{0, 1}};

/// `front`, whose alpha is its opacity, over `back`; straight alpha. An opaque back gives
/// mix(back, front, opacity), a clear one gives front as it is.
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

void require_valid(const std::string& where, const TransferFunction& tf) {
    if (tf.color.empty()) throw Error(fmt::format("{}: no colour, expected at least one", where));
    require_points(where, "colour", tf.color);
    require_points(where, "opacity", tf.opacity);
}

Rgba evaluate(const TransferFunction& tf, float v) {
    require_valid("transfer function " + tf.name, tf);
    if (!in_unit_range(v))
        throw Error(fmt::format("transfer function {} at V = {}, expected [0, 1]", tf.name, v));
    const auto [r, g, b] = Ramp<3>(tf.color)(v);
    const auto [opacity] = Ramp<1>(tf.opacity.empty() ? kOpaque : tf.opacity)(v);
    return {r, g, b, opacity};
}

Image shade(const DepthImage& depth, const TransferFunction& tf, const ShadeOptions& options) {
    require_valid("transfer function " + tf.name, tf);
    const Rgba& background = options.background;
    for (const float c : {background.r, background.g, background.b, background.a})
        if (!in_unit_range(c))
            throw Error(fmt::format("background ({}, {}, {}, {}), expected numbers in [0, 1]",
                                    background.r, background.g, background.b, background.a));
    require_valid("shade", depth);

    const bool opaque = tf.opacity.empty();
    const Ramp<3> color(tf.color);
    const Ramp<1> opacity(opaque ? kOpaque : tf.opacity);
    Image image(depth.width, depth.height);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, depth.depth.size(), 1 << 14),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i) {
                              const float t = depth.depth[i];
                              if (!(t > 0)) {
                                  image.pixel[i] = background;
                                  continue;
                              }
                              const float v = 1 - std::exp(-t);
                              const auto [r, g, b] = color(v);
                              const float a =
                                  (opaque ? 1 : opacity(v)[0]) * (options.blend ? v : 1);
                              image.pixel[i] = over({r, g, b, a}, background);
                          }
                      });
    return image;
}

}  // namespace vog
