// value_pieces.cpp: Pieces of a transfer function of values, and their search.
#include "render/by_value/value_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace vog::by_value {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Points around the values from `start` on: the last one at or before it, and the next.
template <class Point>
std::pair<const Point*, const Point*> points_from(const std::vector<Point>& points, double start) {
    const auto after = std::upper_bound(points.begin(), points.end(), start,
                                        [](double v, const Point& p) { return v < p.value; });
    if (after == points.begin()) return {&points.front(), &points.front()};
    return {&*(after - 1), after == points.end() ? &points.back() : &*after};
}

/// Change per unit of value; 0 beyond the ends.
double slope(double from, double to, double width) { return width > 0 ? (to - from) / width : 0; }

}  // namespace

bool has_surface(const ValueTransfer& transfer) {
    return std::ranges::adjacent_find(
               transfer.opacity, [](const ValueOpacity& a, const ValueOpacity& b) {
                   return a.value == b.value && std::max(a.opacity, b.opacity) >= kMostOpacity;
               }) != transfer.opacity.end();
}

device::GradientFactor gradient_factor(const ValueTransfer& transfer) {
    const std::vector<GradientOpacity>& points = transfer.gradient;
    validate(points);
    device::GradientFactor out{};
    if (points.empty()) return out;
    static_assert(device::GradientFactor::kMostParts + 1 == kMostGradientPoints);
    const double most = points.back().magnitude;
    out.first = static_cast<float>(points.front().factor);
    for (std::size_t n = 0; n + 1 < points.size(); ++n) {
        const auto [from, low] = points[n];
        const auto [to, high] = points[n + 1];
        out.start[n] = static_cast<float>(from / most);
        out.width[n] = static_cast<float>((to - from) / most);
        out.slope[n] = static_cast<float>((high - low) * (most / (to - from)));
        ++out.parts;
    }
    return out;
}

ValuePieces::ValuePieces(const ValueTransfer& transfer)
    : first_(device::kValueBuckets),
      unit_distance_(transfer.unit_distance),
      gradient_(gradient_factor(transfer)) {
    validate(transfer);
    if (has_gradient()) steepest_ = transfer.gradient.back().magnitude;
    std::vector<double> starts{-kInfinity};
    for (const ValueColor& point : transfer.color) starts.push_back(point.value);
    for (const ValueOpacity& point : transfer.opacity) starts.push_back(point.value);
    std::sort(starts.begin(), starts.end());
    starts.erase(std::unique(starts.begin(), starts.end()), starts.end());
    for (std::size_t n = 0; n < starts.size(); ++n) {
        const auto [from, to] = points_from(transfer.color, starts[n]);
        const auto [low, high] = points_from(transfer.opacity, starts[n]);
        device::ValuePiece piece{};
        piece.start = starts[n];
        piece.end = n + 1 < starts.size() ? starts[n + 1] : kInfinity;
        piece.origin = n == 0 ? piece.end : piece.start;
        // Both at the piece's origin, from the points that may lie before it.
        const double width = to->value - from->value, rise = high->value - low->value;
        const std::array<double, 3> a{double{from->r}, double{from->g}, double{from->b}};
        const std::array<double, 3> b{double{to->r}, double{to->g}, double{to->b}};
        for (std::size_t c = 0; c < 3; ++c) {
            piece.color_slope[c] = slope(a[c], b[c], width);
            piece.color[c] =
                a[c] + (width > 0 ? (piece.origin - from->value) / width : 0) * (b[c] - a[c]);
        }
        piece.opacity_slope = slope(low->opacity, high->opacity, rise);
        piece.opacity = low->opacity + (rise > 0 ? (piece.origin - low->value) / rise : 0) *
                                           (high->opacity - low->opacity);
        piece.extinction = piece.opacity_slope == 0 ? table().extinction(piece.opacity) : -1;
        pieces_.push_back(piece);
    }
    lowest_ = starts[1];
    const double range = starts.back() - lowest_;
    if (range > 0 && std::isfinite(device::kValueBuckets / range))
        buckets_per_value_ = device::kValueBuckets / range;
    std::uint32_t at = 0;
    for (std::size_t b = 0; b < first_.size(); ++b) {
        const double value = lowest_ + static_cast<double>(b) / device::kValueBuckets * range;
        while (at + 1 < pieces_.size() && value >= pieces_[at].end) ++at;
        first_[b] = at;
    }
}

}  // namespace vog::by_value
