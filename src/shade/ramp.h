// ramp.h: piecewise linear functions of V, evaluated in constant time.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "vog/shade.h"

namespace vog::shading {

inline bool in_unit_range(float x) { return x >= 0 && x <= 1; }  // false for NaN

inline std::array<float, 3> components(const ColorPoint& point) {
    return {point.r, point.g, point.b};
}
inline std::array<float, 1> components(const OpacityPoint& point) { return {point.opacity}; }

/// Piecewise linear function of v in [0, 1] with N components. Each of 1024 equal buckets of v
/// stores its first piece, where the search starts: constant time, exact values.
template <std::size_t N>
class Ramp {
  public:
    template <class Point>
    explicit Ramp(const std::vector<Point>& points) {
        // Constant before the first point and after the last, linear between.
        constexpr float kInfinity = std::numeric_limits<float>::infinity();
        pieces_.push_back({points.front().v, 0, components(points.front()), {}});
        for (std::size_t i = 1; i < points.size(); ++i) {
            const float v0 = points[i - 1].v, width = points[i].v - v0;
            if (width < std::numeric_limits<float>::min()) continue;  // a step: no piece
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

    /// Value at v in [0, 1], or below: before a step at 0.
    std::array<float, N> operator()(float v) const {
        if (v < 0) return pieces_.front().value;
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
        float end, start;                   ///< v
        std::array<float, N> value, slope;  ///< value at `start`; change per unit of v
    };
    std::vector<Piece> pieces_;
    std::array<std::uint32_t, kBuckets> first_{};
};

/// Opacity 1 for every V.
inline const std::vector<OpacityPoint> kOpaque{{0, 1}};

}  // namespace vog::shading
