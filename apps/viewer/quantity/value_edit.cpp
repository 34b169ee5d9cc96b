// value_edit.cpp: edits of transfer functions of values.
#include "quantity/value_edit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace vog::viewer {

namespace {

constexpr std::size_t kLongestHistory = 200;  ///< steps

}  // namespace

ValueRange range_of(const ValueTransfer& transfer) {
    return {std::min(transfer.color.front().value, transfer.opacity.front().value),
            std::max(transfer.color.back().value, transfer.opacity.back().value)};
}

ValueTransfer with_map(ValueTransfer transfer, const TransferFunction& map, bool log) {
    const auto [lower, upper] = range_of(transfer);
    transfer.color = over_range(transfer_points(map), lower, upper, 1, log).color;
    transfer.name = map.name;
    return transfer;
}

ValueTransfer inverted(ValueTransfer transfer) {
    std::vector<ValueColor>& color = transfer.color;
    const double sum = color.front().value + color.back().value;
    std::ranges::reverse(color);
    for (ValueColor& point : color) point.value = sum - point.value;
    return transfer;
}

ValueTransfer windowed(ValueTransfer transfer, double shift, double factor) {
    const ValueRange range = range_of(transfer);
    const double middle = std::midpoint(range.lower, range.upper);
    const auto moved = [&](double value) { return middle + shift + (value - middle) * factor; };
    for (ValueColor& point : transfer.color) point.value = moved(point.value);
    for (ValueOpacity& point : transfer.opacity) point.value = moved(point.value);
    return transfer;
}

ValueTransfer with_point(ValueTransfer transfer, std::size_t n, ValueOpacity point) {
    std::vector<ValueOpacity>& points = transfer.opacity;
    if (n > 0) point.value = std::max(point.value, points[n - 1].value);
    if (n + 1 < points.size()) point.value = std::min(point.value, points[n + 1].value);
    points[n] = {point.value, std::clamp(point.opacity, 0.0, 1.0)};
    return transfer;
}

ValueTransfer with_new_point(ValueTransfer transfer, ValueOpacity point, std::size_t& index) {
    std::vector<ValueOpacity>& points = transfer.opacity;
    point.opacity = std::clamp(point.opacity, 0.0, 1.0);
    const auto at = std::ranges::upper_bound(points, point.value, {}, &ValueOpacity::value);
    index = static_cast<std::size_t>(at - points.begin());
    points.insert(at, point);
    return transfer;
}

ValueTransfer without_point(ValueTransfer transfer, std::size_t n) {
    if (transfer.opacity.size() > 1)
        transfer.opacity.erase(transfer.opacity.begin() + static_cast<std::ptrdiff_t>(n));
    return transfer;
}

ValueTransfer with_band_moved(ValueTransfer transfer, std::size_t first, std::size_t last,
                              double shift, double factor) {
    std::vector<ValueOpacity>& points = transfer.opacity;
    if (first > 0) shift = std::max(shift, points[first - 1].value - points[first].value);
    if (last + 1 < points.size())
        shift = std::min(shift, points[last + 1].value - points[last].value);
    for (std::size_t n = first; n <= last; ++n)
        points[n] = {points[n].value + shift, std::clamp(points[n].opacity * factor, 0.0, 1.0)};
    return transfer;
}

PointRange band_around(const ValueTransfer& transfer, std::size_t n) {
    const std::vector<ValueOpacity>& points = transfer.opacity;
    PointRange band{n, n};
    while (band.first > 0 && points[band.first - 1].opacity == points[n].opacity) --band.first;
    while (band.last + 1 < points.size() && points[band.last + 1].opacity == points[n].opacity)
        ++band.last;
    if (band.first == band.last || points[n].opacity == 0) return {n, n};
    // Its feet, where the opacity is 0.
    if (band.first > 0 && points[band.first - 1].opacity == 0) --band.first;
    if (band.last + 1 < points.size() && points[band.last + 1].opacity == 0) ++band.last;
    return band;
}

ValueTransfer ramp(ValueTransfer transfer, ValueRange range) {
    transfer.opacity = {{range.lower, 0}, {range.upper, 1}};
    return transfer;
}

ValueTransfer peak(ValueTransfer transfer, ValueRange range) {
    const double middle = std::midpoint(range.lower, range.upper), half = range.width() / 8;
    transfer.opacity = {
        {range.lower, 0}, {middle - half, 0}, {middle, 0.8}, {middle + half, 0}, {range.upper, 0}};
    return transfer;
}

ValueTransfer step(ValueTransfer transfer, ValueRange range) {
    const double middle = std::midpoint(range.lower, range.upper);
    transfer.opacity = {{range.lower, 0}, {middle, 0}, {middle, 0.9}, {range.upper, 0.9}};
    return transfer;
}

void ValueHistory::begin(ValueTransfer transfer) {
    now_ = std::make_shared<const ValueTransfer>(std::move(transfer));
    before_.clear();
    after_.clear();
}

void ValueHistory::keep(Step before) {
    after_.clear();
    if (dragging_ && drag_kept_) return;
    before_.push_back(std::move(before));
    if (before_.size() > kLongestHistory) before_.erase(before_.begin());
    drag_kept_ = dragging_;
}

void ValueHistory::change(ValueTransfer transfer) {
    if (now_ && transfer == *now_) return;
    if (now_) keep({now_, {}});
    now_ = std::make_shared<const ValueTransfer>(std::move(transfer));
}

void ValueHistory::change_lights(const std::vector<DirectionalLight>& lights) {
    keep({now_, lights});
}

void ValueHistory::step(std::vector<Step>& from, std::vector<Step>& to,
                        std::vector<DirectionalLight>& lights) {
    if (from.empty()) return;
    Step next = std::move(from.back());
    from.pop_back();
    to.push_back({std::exchange(now_, next.transfer), {}});
    if (next.lights) to.back().lights = std::exchange(lights, std::move(*next.lights));
}

}  // namespace vog::viewer
