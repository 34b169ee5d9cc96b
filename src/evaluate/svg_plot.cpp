// svg_plot.cpp: axes, ticks, legend and lines of a plot.
#include "evaluate/svg_plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/html_text.h"

namespace vog::evaluation {

namespace {

// Okabe & Ito, "Color Universal Design" (2008), in an order whose neighbours differ in brightness.
// Two more for longer lists.
constexpr std::array<const char*, 8> kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#e69f00", "#56b4e9", "#1d2329", "#7b5c34"};
constexpr const char* kOthersColor = "#777777";

constexpr double kWidth = 460, kHeight = 330;
constexpr double kLeft = 50, kRight = 14, kBottom = 46, kLegendLine = 17, kTitle = 26;

struct Axis {
    double low = 0, high = 1;
    std::vector<double> ticks;
};

/// At most six ticks at 1, 2 or 5 times a power of ten that cover [low, high].
Axis round_axis(double low, double high) {
    if (!(high > low)) {
        const double pad = std::max(std::abs(high) * 0.1, 1e-9);
        low -= pad;
        high += pad;
    }
    const double rough = (high - low) / 5, power = std::pow(10, std::floor(std::log10(rough)));
    double step = 10 * power;
    for (const double s : {1.0, 2.0, 5.0})
        if (s * power >= rough) {
            step = s * power;
            break;
        }
    Axis axis{std::floor(low / step) * step, std::ceil(high / step) * step, {}};
    const int count = static_cast<int>(std::lround((axis.high - axis.low) / step));
    for (int n = 0; n <= count; ++n) axis.ticks.push_back(axis.low + n * step);
    return axis;
}

/// Ticks at powers of ten, and at 2 and 5 times them where those are few; as log10.
Axis log_axis(double low, double high) {
    Axis axis{std::log10(low), std::log10(high), {}};
    const double pad = std::max(0.04 * (axis.high - axis.low), 0.05);
    axis.low -= pad;
    axis.high += pad;
    const bool fine = axis.high - axis.low < 2.2;
    for (int power = static_cast<int>(std::floor(axis.low)); power <= axis.high; ++power)
        for (const double step : {1.0, 2.0, 5.0}) {
            const double tick = power + std::log10(step);
            if ((fine || step == 1) && tick >= axis.low && tick <= axis.high)
                axis.ticks.push_back(tick);
        }
    return axis;
}

/// Tick label: 20000 -> "20 k".
std::string short_number(double value) {
    const char* units[] = {"", " k", " M", " G", " T"};
    std::size_t unit = 0;
    while (std::abs(value) >= 999.5 && unit + 1 < std::size(units)) value /= 1000, ++unit;
    return fmt::format("{:.4g}{}", std::abs(value) < 1e-12 ? 0.0 : value, units[unit]);
}

bool drawable(const Plot& plot, const PlotPoint& point) {
    return std::isfinite(point.x) && std::isfinite(point.y) && (!plot.log_x || point.x > 0) &&
           (!plot.log_y || point.y > 0);
}

/// Map from plot coordinates to SVG coordinates.
struct Frame {
    Axis x, y;
    double top = 0;
    bool log_x = false, log_y = false;

    double px(double value) const {
        const double v = log_x ? std::log10(value) : value;
        return kLeft + (v - x.low) / (x.high - x.low) * (kWidth - kLeft - kRight);
    }
    double py(double value) const {
        const double v = log_y ? std::log10(value) : value;
        return kHeight - kBottom - (v - y.low) / (y.high - y.low) * (kHeight - kBottom - top);
    }
};

/// Positions of the legend's entries, which are wrapped into lines.
struct LegendEntry {
    double x = 0;
    int line = 0;
};
std::vector<LegendEntry> legend_of(const Plot& plot) {
    constexpr double kCharacter = 7, kSample = 28,
                     kGap = 14;  // of a character at 12 pixels, rounded up
    std::vector<LegendEntry> entries;
    LegendEntry at{kLeft, 0};
    for (const PlotSeries& series : plot.series) {
        const double width = kSample + kCharacter * static_cast<double>(series.name.size()) + kGap;
        if (at.x > kLeft && at.x + width > kWidth + kGap) at = {kLeft, at.line + 1};
        entries.push_back(at);
        at.x += width;
    }
    return entries;
}

Frame frame_of(const Plot& plot, int legend_lines) {
    std::array<double, 2> x{HUGE_VAL, -HUGE_VAL}, y = x;
    for (const PlotSeries& series : plot.series)
        for (const PlotPoint& point : series.points)
            if (drawable(plot, point)) {
                x = {std::min(x[0], point.x), std::max(x[1], point.x)};
                y = {std::min(y[0], point.y), std::max(y[1], point.y)};
            }
    if (x[0] > x[1]) x = y = {1, 10};  // nothing to draw
    Frame frame;
    frame.top = kTitle + kLegendLine * legend_lines + 6;
    frame.log_x = plot.log_x;
    frame.log_y = plot.log_y;
    frame.y = plot.log_y ? log_axis(y[0], y[1]) : round_axis(y[0], y[1]);
    if (!plot.categories.empty())
        frame.x = {-0.4, static_cast<double>(plot.categories.size()) - 0.6, {}};
    else
        frame.x = plot.log_x ? log_axis(x[0], x[1]) : round_axis(x[0], x[1]);
    return frame;
}

std::string text(double x, double y, const char* anchor, const std::string& content,
                 const char* more = "") {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y,
                       anchor, more, escaped(content));
}

std::string axes(const Plot& plot, const Frame& frame) {
    std::string out;
    const double bottom = kHeight - kBottom;
    for (const double tick : frame.y.ticks) {
        const double value = plot.log_y ? std::pow(10, tick) : tick, y = frame.py(value);
        out +=
            fmt::format("<line class=\"grid\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>\n",
                        kLeft, kWidth - kRight, y, y);
        out += text(kLeft - 7, y + 4, "end", short_number(value));
    }
    for (const double tick : frame.x.ticks) {
        const double value = plot.log_x ? std::pow(10, tick) : tick, x = frame.px(value);
        out +=
            fmt::format("<line class=\"grid\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{}\" y2=\"{}\"/>\n",
                        x, x, frame.top, bottom);
        out += text(x, bottom + 17, "middle", short_number(value));
    }
    for (std::size_t n = 0; n < plot.categories.size(); ++n) {
        // '|' separates two lines.
        const std::string& name = plot.categories[n];
        const std::size_t bar = name.find('|');
        const double x = frame.px(static_cast<double>(n));
        out += text(x, bottom + 17, "middle", name.substr(0, bar));
        if (bar != std::string::npos) out += text(x, bottom + 31, "middle", name.substr(bar + 1));
    }
    const double middle = 0.5 * (kLeft + kWidth - kRight);
    out += text(middle, kHeight - 8, "middle", plot.x_label, " class=\"label\"");
    out += text(4, 17, "start", plot.title, " class=\"title\"");
    out += fmt::format("<line class=\"axis\" x1=\"{}\" x2=\"{}\" y1=\"{}\" y2=\"{}\"/>\n", kLeft,
                       kWidth - kRight, bottom, bottom);
    const double center = 0.5 * (frame.top + bottom);
    return out + fmt::format(
                     "<text class=\"label\" text-anchor=\"middle\" transform=\"translate(13 "
                     "{:.1f}) rotate(-90)\">{}</text>\n",
                     center, escaped(plot.y_label));
}

std::string line_style(const PlotSeries& series, std::size_t index) {
    return fmt::format("stroke=\"{}\"{}",
                       series.dashed ? kOthersColor : kColors[index % kColors.size()],
                       series.dashed ? " stroke-dasharray=\"5 4\"" : "");
}

std::string draw(const Plot& plot, const Frame& frame, const PlotSeries& series,
                 std::size_t index) {
    std::string path, marks;
    const char* color = series.dashed ? kOthersColor : kColors[index % kColors.size()];
    bool joined = false;
    for (const PlotPoint& point : series.points) {
        if (!drawable(plot, point)) {
            joined = false;
            continue;
        }
        const double x = frame.px(point.x), y = frame.py(point.y);
        path += fmt::format("{}{:.1f} {:.1f} ", joined ? "L" : "M", x, y);
        joined = true;
        marks += fmt::format(
            "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\" "
            "stroke=\"{}\"><title>{}</title>"
            "</circle>\n",
            x, y, series.dashed ? "#ffffff" : color, color, escaped(point.tooltip));
    }
    if (!plot.lines || path.empty()) return marks;
    return fmt::format("<path class=\"series\" {} d=\"{}\"/>\n", line_style(series, index), path) +
           marks;
}

}  // namespace

std::string svg(const Plot& plot) {
    const std::vector<LegendEntry> legend = legend_of(plot);
    const Frame frame = frame_of(plot, legend.empty() ? 0 : legend.back().line + 1);
    std::string out = fmt::format(
        "<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" "
        "aria-label=\"{}\">\n",
        kWidth, kHeight, escaped(plot.title));
    out += axes(plot, frame);
    for (std::size_t n = 0; n < plot.series.size(); ++n) {
        const PlotSeries& series = plot.series[n];
        const double y = kTitle + kLegendLine * (legend[n].line + 0.5);
        out += fmt::format("<path class=\"series\" {} d=\"M{:.1f} {:.1f} h20\"/>\n",
                           line_style(series, n), legend[n].x, y);
        out += text(legend[n].x + 26, y + 4, "start", series.name);
        out += draw(plot, frame, series, n);
    }
    return out + "</svg>\n";
}

}  // namespace vog::evaluation
