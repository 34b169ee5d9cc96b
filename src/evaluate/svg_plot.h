// svg_plot.h: line plots as SVG, for pages without scripts; legible at the width of a phone.
#pragma once

#include <string>
#include <vector>

namespace vog::evaluation {

struct PlotPoint {
    double x = 0, y = 0;
    std::string tooltip;  ///< shown while the pointer is over the point
};

struct PlotSeries {
    std::string name;
    std::vector<PlotPoint> points;  ///< in drawing order; a non-finite one interrupts the line
    bool dashed = false;            ///< drawn dashed: figures from other sources
};

struct Plot {
    std::string title, x_label, y_label;
    std::vector<std::string> categories;  ///< labels of x = 0, 1, ...; empty: a numeric axis
    bool log_x = false, log_y = false;
    std::vector<PlotSeries> series;  ///< at most eight, and dashed ones
    bool lines = true;               ///< join the points of a series
};

/// The plot as an <svg> element, with axes, ticks at round values, a legend, and colours that
/// colour-blind readers can tell apart.
std::string svg(const Plot& plot);

}  // namespace vog::evaluation
