// color_scale.cpp: Positions, ranges and ticks of a colour scale.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <string>
#include <utility>

#include "data/image_checks.h"
#include "shade/annotation/ticks.h"
#include "vog/error.h"
#include "vog/quantity.h"

namespace vog {

namespace {

using Kind = ColorScale::Kind;

void require_range(const ColorScale& scale) {
    if (scale.kind == Kind::visibility) return;
    const bool log = scale.kind == Kind::log;
    if (!std::isfinite(scale.low) || !std::isfinite(scale.high) || !(scale.low < scale.high) ||
        (log && !(scale.low > 0)))
        throw Error(
            fmt::format("range {} to {}, expected finite numbers, the first below the second{}",
                        scale.low, scale.high, log ? ", above 0 (logarithmic)" : ""));
}

/// Appends a tick unless it is closer than `gap` to one that is there.
void add_tick(std::vector<double>& ticks, const ColorScale& scale, double value, double gap) {
    // Ends of the range count in spite of rounding.
    constexpr double kRounding = 1e-9;
    if (scale.kind != Kind::visibility) {
        const double reach = kRounding * (scale.high - scale.low);
        if (value < scale.low - reach || value > scale.high + reach) return;
    }
    const double at = scale_position(scale, value);
    for (const double tick : ticks)
        if (std::abs(at - scale_position(scale, tick)) < gap) return;
    ticks.push_back(value);
}

/// The least 1, 2 or 5 times a power of ten that is at least `least`.
double round_step(double least) {
    const double power = std::pow(10, std::floor(std::log10(least)));
    for (const double step : {1.0, 2.0, 5.0})
        if (step * power >= least * (1 - 1e-12)) return step * power;
    return 10 * power;
}

std::string text_of(double value, int digits) {
    if (value == 0) return "0";  // not -0
    std::string text = fmt::format("{:.{}g}", value, digits);
    const std::size_t e = text.find('e');
    if (e != std::string::npos) {
        // 1e-07 as 1e-7, 1e+06 as 1e6
        std::string exponent = text.substr(e + 1);
        const bool negative = exponent.front() == '-';
        exponent.erase(0, exponent.find_first_not_of("+-0"));
        text = text.substr(0, e + 1) + (negative ? "-" : "") + exponent;
    }
    return text;
}

}  // namespace

double scale_position(const ColorScale& scale, double value) {
    require_range(scale);
    if (scale.kind == Kind::visibility) return value > 0 ? -std::expm1(-value) : 0;
    if (!(value > scale.low)) return 0;
    if (value >= scale.high) return 1;
    return scale.kind == Kind::linear
               ? (value - scale.low) / (scale.high - scale.low)
               : std::log(value / scale.low) / std::log(scale.high / scale.low);
}

DepthImage column_density(const DepthImage& depth) {
    require_valid("column density", depth);
    DepthImage column = depth;
    set_extinction(column, 1);
    return column;
}

namespace {

/// Value of nearest rank, ceil(share n) of n.
double percentile(std::vector<float>& values, double share) {
    const auto rank =
        static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
    std::nth_element(values.begin(), at, values.end());
    return double{*at};
}

/// Whether a linear scale up to `high` would have half of the values, all above 0, in its lowest quarter.
bool crowd_below(std::vector<float>& values, double high) {
    return !values.empty() && percentile(values, 0.5) < high / 4;
}

}  // namespace

ColorScale automatic_scale(std::span<const DepthImage> images, ScaleFit fit) {
    constexpr double kLow = 0.05, kDecades = 1e4;
    std::vector<float> shown;
    for (const DepthImage& image : images) {
        require_valid("values", image);
        std::ranges::copy_if(image.depth, std::back_inserter(shown),
                             [](float value) { return value > 0; });
    }
    const double largest = shown.empty() ? 1 : double{*std::ranges::max_element(shown)};
    if (fit != ScaleFit::log && !(fit == ScaleFit::automatic && crowd_below(shown, largest)))
        return {Kind::linear, 0, largest};
    // One value alone gets the decade below it.
    const double faint = shown.empty() ? 0 : percentile(shown, kLow);
    return {Kind::log, std::max(std::min(faint, largest / 10), largest / kDecades), largest};
}

ColorScale fitted_scale(std::span<const float> values, ScaleFit fit) {
    constexpr double kLow = 0.01, kHigh = 0.99, kDecades = 1e4;
    std::vector<float> counted;
    for (const float value : values)
        if (std::isfinite(value))
            counted.push_back(fit == ScaleFit::symmetric ? std::abs(value) : value);
    bool log = fit == ScaleFit::log;
    if (fit == ScaleFit::automatic &&
        std::ranges::none_of(counted, [](float value) { return value < 0; })) {
        std::vector<float> above = counted;
        std::erase(above, 0.0f);
        log = !above.empty() && crowd_below(above, percentile(above, kHigh));
    }
    if (log) std::erase_if(counted, [](float value) { return !(value > 0); });
    if (counted.empty() && log)
        throw Error("a logarithmic scale, expected at least one value above 0");
    if (counted.empty()) return {Kind::linear, fit == ScaleFit::symmetric ? -1.0 : 0.0, 1};
    const double high = percentile(counted, kHigh);
    if (fit == ScaleFit::symmetric) {
        const double most = high > 0 ? high : 1;
        return {Kind::linear, -most, most};
    }
    const double low = std::max(percentile(counted, kLow), log ? high / kDecades : -HUGE_VAL);
    if (low < high) return {log ? Kind::log : Kind::linear, low, high};
    // Equal values: a range around them.
    if (log) return {Kind::log, low / 2, high * 2};
    const double margin = low != 0 ? 0.01 * std::abs(low) : 1;
    return {Kind::linear, low - margin, high + margin};
}

std::vector<double> scale_ticks(const ColorScale& scale, double least_gap) {
    require_range(scale);
    std::vector<double> ticks;
    if (scale.kind == Kind::visibility) {
        // By importance: the ends, then what divides the bar most evenly.
        for (const double t : {0.0, 1.0, 0.5, 2.0, 0.2, 5.0, 3.0, 0.1})
            add_tick(ticks, scale, t, least_gap);
    } else if (scale.kind == Kind::linear) {
        // Eight at most: more would be hard to tell apart.
        const double step = round_step(std::max(least_gap, 1.0 / 8) * (scale.high - scale.low));
        for (double n = std::ceil(scale.low / step - 1e-9); n * step <= scale.high + 1e-9 * step;
             ++n)
            add_tick(ticks, scale, n * step, 0);
    } else {
        const double first = std::floor(std::log10(scale.low));
        const double last = std::ceil(std::log10(scale.high));
        // Decades alone where they are many: every second, third, ... of them.
        const double decade = 1 / std::log10(scale.high / scale.low);
        const double every = std::max(1.0, std::ceil(least_gap / decade - 1e-9));
        for (double n = first; n <= last; ++n)
            if (std::fmod(std::abs(n), every) == 0)
                add_tick(ticks, scale, std::pow(10, n), least_gap);
        if (every == 1)
            for (const double digit : {5.0, 2.0})
                for (double n = first; n <= last; ++n)
                    add_tick(ticks, scale, digit * std::pow(10, n), least_gap);
        // A range within two such values: linear steps.
        if (ticks.size() < 2)
            for (const double value : scale_ticks({Kind::linear, scale.low, scale.high}, least_gap))
                add_tick(ticks, scale, value, least_gap);
    }
    std::ranges::sort(ticks);
    return ticks;
}

std::string with_unit(const std::string& name, const std::string& unit) {
    return unit.empty() ? name : name + " [" + unit + "]";
}

std::string tick_text(double value) {
    // Six digits take away the rounding of multiples: 0.30000000000000004.
    return text_of(value, 6);
}

std::vector<shading::Tick> shading::ticks_of(const ColorScale& scale, double least_gap,
                                             bool whole) {
    std::vector<double> values = scale_ticks(scale, least_gap);
    if (whole) std::erase_if(values, [](double v) { return std::abs(v - std::round(v)) > 1e-6; });
    std::vector<Tick> ticks;
    for (std::size_t n = 0; n < values.size(); ++n) {
        double gap = std::abs(values[n]);
        if (n > 0) gap = std::min(gap, values[n] - values[n - 1]);
        if (n + 1 < values.size()) gap = std::min(gap, values[n + 1] - values[n]);
        const int digits =
            gap > 0 ? static_cast<int>(std::ceil(std::log10(std::abs(values[n]) / gap))) + 1 : 6;
        ticks.push_back({values[n], text_of(values[n], std::clamp(digits, 6, 15))});
    }
    return ticks;
}

shading::AxisTicks shading::axis_ticks(double low, double high, double least_gap) {
    constexpr std::size_t kLongest = 6;  // more do not fit the room that pictures leave for them
    constexpr double kFar = 10;          // extents from 0
    const auto longest = [](const std::vector<Tick>& ticks) {
        std::size_t glyphs = 0;
        for (const Tick& tick : ticks) glyphs = std::max(glyphs, tick.text.size());
        return glyphs;
    };
    AxisTicks axis{ticks_of({Kind::linear, low, high}, least_gap), {}};
    const double middle = std::midpoint(low, high);
    if (longest(axis.ticks) <= kLongest || std::abs(middle) < kFar * (high - low)) return axis;
    const double power = std::pow(10, 1 + std::ceil(std::log10(high - low)));
    const double origin = power * std::round(middle / power);
    std::vector<Tick> from = ticks_of({Kind::linear, low - origin, high - origin}, least_gap);
    if (longest(from) >= longest(axis.ticks)) return axis;
    for (Tick& tick : from) tick.value += origin;
    const std::string brief = tick_text(std::abs(origin));
    return {
        std::move(from),
        fmt::format(" {} {}", origin < 0 ? '+' : '-',
                    std::stod(brief) == std::abs(origin) ? brief : text_of(std::abs(origin), 15))};
}

}  // namespace vog
