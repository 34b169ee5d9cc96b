// value_transfer.cpp: colour and extinction of values.
#include "vog/value_transfer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "shade/transfer_function.h"
#include "vog/error.h"

namespace vog {

namespace {

/// Piece of a list of points around a value.
template <class Point>
struct Piece {
    const Point *from, *to;
    double share;  ///< of `to`
};
template <class Point>
Piece<Point> piece_at(const std::vector<Point>& points, double value) {
    const auto after = std::upper_bound(points.begin(), points.end(), value,
                                        [](double v, const Point& p) { return v < p.value; });
    if (after == points.begin()) return {&points.front(), &points.front(), 0};
    if (after == points.end()) return {&points.back(), &points.back(), 0};
    const Point &from = *(after - 1), &to = *after;
    return {&from, &to, (value - from.value) / (to.value - from.value)};
}

template <class Points>
void require_sorted(const Points& points, const std::string& where, const char* what) {
    if (points.empty())
        throw Error(fmt::format("{}: no points of {}, expected at least one", where, what));
    for (std::size_t n = 0; n < points.size(); ++n) {
        if (!std::isfinite(points[n].value))
            throw Error(fmt::format("{}: {} at a value of {}, expected finite", where, what,
                                    points[n].value));
        if (n > 0 && points[n].value < points[n - 1].value)
            throw Error(fmt::format("{}: {} at {} after {}, expected sorted points", where, what,
                                    points[n].value, points[n - 1].value));
    }
}

}  // namespace

void validate(const ValueTransfer& transfer) {
    const std::string where =
        transfer.name.empty() ? "transfer function" : "transfer function " + transfer.name;
    require_sorted(transfer.color, where, "colour");
    require_sorted(transfer.opacity, where, "opacity");
    for (const ValueColor& point : transfer.color)
        for (const float c : {point.r, point.g, point.b})
            if (!(c >= 0 && c <= 1))
                throw Error(fmt::format("{}: colour component {} at {}, expected in [0, 1]", where,
                                        c, point.value));
    for (const ValueOpacity& point : transfer.opacity)
        if (!(point.opacity >= 0 && point.opacity <= 1))
            throw Error(fmt::format("{}: opacity {} at {}, expected in [0, 1]", where,
                                    point.opacity, point.value));
    if (!(transfer.unit_distance > 0) || !std::isfinite(transfer.unit_distance))
        throw Error(fmt::format("{}: unit_distance {}, expected a finite length > 0", where,
                                transfer.unit_distance));
}

ValueLight light_of(const ValueTransfer& transfer, double value) {
    validate(transfer);
    if (!std::isfinite(value))
        throw Error(fmt::format("transfer function: value {}, expected finite", value));
    const auto color = piece_at(transfer.color, value);
    const auto opacity = piece_at(transfer.opacity, value);
    const auto mix = [](double from, double to, double share) {
        return from + share * (to - from);
    };
    const double absorbed =
        std::min(mix(opacity.from->opacity, opacity.to->opacity, opacity.share), kMostOpacity);
    return {-std::log1p(-absorbed) / transfer.unit_distance,
            mix(double{color.from->r}, double{color.to->r}, color.share),
            mix(double{color.from->g}, double{color.to->g}, color.share),
            mix(double{color.from->b}, double{color.to->b}, color.share)};
}

ValueTransfer over_range(const TransferFunction& tf, double lower, double upper,
                         double unit_distance) {
    shading::require_valid("transfer function " + tf.name, tf);
    if (!(lower < upper) || !std::isfinite(lower) || !std::isfinite(upper))
        throw Error(
            fmt::format("transfer function {}: range {} to {}, expected finite and ascending",
                        tf.name, lower, upper));
    ValueTransfer out;
    out.name = tf.name;
    out.unit_distance = unit_distance;
    const auto value = [&](float v) { return lower + double{v} * (upper - lower); };
    for (const ColorPoint& point : tf.color)
        out.color.push_back({value(point.v), point.r, point.g, point.b});
    for (const OpacityPoint& point : tf.opacity)
        out.opacity.push_back({value(point.v), double{point.opacity}});
    if (out.opacity.empty()) out.opacity = {{lower, 0}, {upper, 1}};
    validate(out);
    return out;
}

}  // namespace vog
