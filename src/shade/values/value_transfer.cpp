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

double mix(double from, double to, double share) { return from + share * (to - from); }

void set_between(ValueColor& point, const ValueColor& a, const ValueColor& b, float share) {
    point.r = std::lerp(a.r, b.r, share), point.g = std::lerp(a.g, b.g, share);
    point.b = std::lerp(a.b, b.b, share);
}
void set_between(ValueOpacity& point, const ValueOpacity& a, const ValueOpacity& b, float share) {
    point.opacity = std::lerp(a.opacity, b.opacity, double{share});
}
/// Divides pieces of shares of a logarithmic range: between points the function is linear in the value.
template <class Point>
void divide(std::vector<Point>& points) {
    constexpr double kLongest = 1.0 / 32;
    std::vector<Point> all;
    for (std::size_t n = 0; n < points.size(); ++n) {
        if (n > 0) {
            const Point &from = points[n - 1], &to = points[n];
            const int parts = static_cast<int>(std::ceil((to.value - from.value) / kLongest));
            for (int part = 1; part < parts; ++part) {
                Point& point = all.emplace_back(from);
                const double share = double(part) / parts;
                point.value = mix(from.value, to.value, share);
                set_between(point, from, to, static_cast<float>(share));
            }
        }
        all.push_back(points[n]);
    }
    points = std::move(all);
}

double opacity_at(const ValueTransfer& transfer, double value) {
    const auto piece = piece_at(transfer.opacity, value);
    return mix(piece.from->opacity, piece.to->opacity, piece.share);
}

}  // namespace

void validate(const std::vector<GradientOpacity>& points) {
    if (points.empty()) return;
    if (points.size() < 2 || points.size() > kMostGradientPoints)
        throw Error(fmt::format("gradient opacity: {} points, expected 2 to {}", points.size(),
                                kMostGradientPoints));
    for (std::size_t n = 0; n < points.size(); ++n) {
        const auto [magnitude, factor] = points[n];
        if (!(magnitude >= 0 && std::isfinite(magnitude)))
            throw Error(
                fmt::format("gradient opacity: magnitude {}, expected finite, from 0", magnitude));
        if (!(factor >= 0 && factor <= 1))
            throw Error(fmt::format("gradient opacity: factor {} at {}, expected in [0, 1]", factor,
                                    magnitude));
        if (n > 0 && !(magnitude > points[n - 1].magnitude))
            throw Error(fmt::format("gradient opacity: {} after {}, expected ascending magnitudes",
                                    magnitude, points[n - 1].magnitude));
    }
}

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
    validate(transfer.gradient);
}

ValueLight light_of(const ValueTransfer& transfer, double value) {
    validate(transfer);
    if (!std::isfinite(value))
        throw Error(fmt::format("transfer function: value {}, expected finite", value));
    const auto color = piece_at(transfer.color, value);
    const double absorbed = std::min(opacity_at(transfer, value), kMostOpacity);
    return {-std::log1p(-absorbed) / transfer.unit_distance,
            mix(double{color.from->r}, double{color.to->r}, color.share),
            mix(double{color.from->g}, double{color.to->g}, color.share),
            mix(double{color.from->b}, double{color.to->b}, color.share)};
}

ValueTransfer over_range(const TransferPoints& points, double lower, double upper,
                         double unit_distance, bool log) {
    ValueTransfer out = points.points;
    if (!points.has_unit_distance) out.unit_distance = unit_distance;
    if (points.at_values) lower = points.lower, upper = points.upper;
    if (!(lower < upper) || !std::isfinite(lower) || !std::isfinite(upper))
        throw Error(
            fmt::format("transfer function {}: range {} to {}, expected finite and ascending",
                        out.name, lower, upper));
    if (points.at_values && out.opacity.empty()) out.opacity = {{lower, 0}, {upper, 1}};
    if (!points.at_values) {
        if (log && !(lower > 0))
            throw Error(
                fmt::format("transfer function {}: a logarithmic range {} to {}, expected above 0",
                            out.name, lower, upper));
        const bool ramp = out.opacity.empty();
        if (ramp) out.opacity = {{0, 0}, {1, 1}};
        if (log) divide(out.color), divide(out.opacity);
        // Squares: with shares of the logarithm outer layers of low values would hide all others.
        if (log && ramp)
            for (ValueOpacity& point : out.opacity) point.opacity *= point.opacity;
        const auto place = [&](auto& list) {
            for (auto& point : list)
                point.value = log ? lower * std::pow(upper / lower, point.value)
                                  : lower + point.value * (upper - lower);
        };
        place(out.color), place(out.opacity);
    }
    validate(out);
    return out;
}

ValueTransfer over_range(const TransferFunction& tf, double lower, double upper,
                         double unit_distance) {
    return over_range(transfer_points(tf), lower, upper, unit_distance);
}

TransferPoints transfer_points(const TransferFunction& tf) {
    shading::require_valid("transfer function " + tf.name, tf);
    TransferPoints points;
    points.points.name = tf.name;
    for (const ColorPoint& point : tf.color)
        points.points.color.push_back({double{point.v}, point.r, point.g, point.b});
    for (const OpacityPoint& point : tf.opacity)
        points.points.opacity.push_back({double{point.v}, double{point.opacity}});
    return points;
}

ValueTransfer read_value_transfer(const std::string& name_or_file, double lower, double upper,
                                  double default_unit_distance) {
    return over_range(transfer_points(name_or_file), lower, upper, default_unit_distance);
}

ValueTransfer window_transfer(double center, double width, double unit_distance) {
    if (!(width > 0) || !std::isfinite(width) || !std::isfinite(center))
        throw Error(
            fmt::format("window {},{}: expected a finite centre and a width > 0", center, width));
    const double lower = center - width / 2, upper = center + width / 2;
    ValueTransfer out{"window",
                      {{lower, 0, 0, 0}, {upper, 1, 1, 1}},
                      {{lower, 0}, {upper, kMostOpacity}},
                      unit_distance};
    validate(out);
    return out;
}

ValueTransfer band_transfer(std::vector<ValueBand> bands, double unit_distance) {
    if (bands.empty()) throw Error("bands: none, expected at least one");
    for (const ValueBand& band : bands)
        if (!std::isfinite(band.lower) || !(band.lower < band.upper))
            throw Error(fmt::format("band from {} to {}: expected the first below the second",
                                    band.lower, band.upper));
    std::ranges::sort(bands, {}, &ValueBand::lower);
    ValueTransfer out;
    out.name = "bands";
    out.unit_distance = unit_distance;
    for (std::size_t n = 0; n < bands.size(); ++n) {
        const ValueBand& band = bands[n];
        if (n > 0 && band.lower < bands[n - 1].upper)
            throw Error(fmt::format("band from {} to {} overlaps the one from {} to {}", band.lower,
                                    band.upper, bands[n - 1].lower, bands[n - 1].upper));
        out.color.push_back({band.lower, band.r, band.g, band.b});
        out.opacity.insert(out.opacity.end(), {{band.lower, 0}, {band.lower, band.opacity}});
        if (!std::isfinite(band.upper)) continue;
        out.color.push_back({band.upper, band.r, band.g, band.b});
        out.opacity.insert(out.opacity.end(), {{band.upper, band.opacity}, {band.upper, 0}});
    }
    validate(out);
    return out;
}

ValueTransfer above(ValueTransfer transfer, double threshold) {
    validate(transfer);
    if (!std::isfinite(threshold))
        throw Error(fmt::format("threshold {}, expected a finite value", threshold));
    std::vector<ValueOpacity> kept{{threshold, 0}, {threshold, opacity_at(transfer, threshold)}};
    for (const ValueOpacity& point : transfer.opacity)
        if (point.value > threshold) kept.push_back(point);
    transfer.opacity = std::move(kept);
    return transfer;
}

double most_opacity(const ValueTransfer& transfer, double lower, double upper) {
    validate(transfer);
    if (!(lower <= upper) || !std::isfinite(lower) || !std::isfinite(upper))
        throw Error(
            fmt::format("transfer function {}: range {} to {}, expected finite and ascending",
                        transfer.name, lower, upper));
    double most = std::max(opacity_at(transfer, lower), opacity_at(transfer, upper));
    for (const ValueOpacity& point : transfer.opacity)
        if (lower < point.value && point.value <= upper) most = std::max(most, point.opacity);
    return most;
}

}  // namespace vog
