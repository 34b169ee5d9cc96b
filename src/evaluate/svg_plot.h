// svg_plot.h: line plots as SVG, for pages that need no scripts. Text sizes suit a phone's width.
#pragma once

#include <string>
#include <vector>

namespace vog::evaluation {

struct PlotPoint {
    double x = 0, y = 0;
    std::string tooltip;  ///< shown when the pointer rests on it
};

struct PlotSeries {
    std::string name;
    std::vector<PlotPoint> points;  ///< drawn in order; one that is not finite breaks the line
    bool dashed = false;            ///< figures of others
};

struct Plot {
    std::string title, x_label, y_label;
    std::vector<std::string> categories;  ///< names of x = 0, 1, ...; empty: x is a number
    bool log_x = false, log_y = false;
    std::vector<PlotSeries> series;  ///< at most six
    bool lines = true;               ///< join the points of a series
};

/// An <svg> element, coloured for colour-blind eyes, with axes, round ticks and a legend.
std::string svg(const Plot& plot);

}  // namespace vog::evaluation
