// rate_plots.cpp: error over bytes, a line for each series.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "evaluate/evaluation_report.h"
#include "evaluate/rate/rate_report.h"
#include "evaluate/svg_plot.h"
#include "vog/text.h"

namespace vog::evaluation {

namespace {

/// Range of the axis: below, nothing can be recognised; above, nothing differs to the eye.
constexpr double kLowestDb = 25, kHighestDb = 65;
/// Voxels: PSNR over the largest density, which few voxels have.
constexpr double kHighestVoxelDb = 80;

Plot plot_of(const RateDistortion& results, const std::string& title, RateFigure figure,
             std::size_t function, double lowest_db, double highest_db) {
    Plot plot;
    plot.title = title;
    plot.x_label = "bytes";
    plot.y_label = "PSNR, dB";
    plot.log_x = true;
    double lossless = HUGE_VAL, low = HUGE_VAL, high = -HUGE_VAL;
    for (const std::string& name : rate_series(results)) {
        // Models with and without values are the same Gaussians: of T and of voxels the smaller files count.
        const bool by_value = figure == RateFigure::rgb_mean || figure == RateFigure::rgb_worst;
        if (is_model_series(name) && (name == "model") == by_value) continue;
        PlotSeries series;
        series.name = name;
        for (const RateRow& row : results.rows) {
            const std::optional<double> value = rate_figure(row, figure, function);
            if (row.series != name || !value) continue;
            const auto bytes = static_cast<double>(row.bytes);
            if (std::isinf(*value)) lossless = std::min(lossless, bytes);
            if (!(*value >= lowest_db && *value <= highest_db)) continue;
            low = std::min(low, *value);
            high = std::max(high, *value);
            series.points.push_back({bytes, *value,
                                     fmt::format("{}, {}: {}, {:.2f} dB", row.series, row.step,
                                                 bytes_text(row.bytes), *value)});
        }
        if (!series.points.empty()) plot.series.push_back(std::move(series));
    }
    if (std::isfinite(lossless) && low <= high) {
        const std::string tooltip =
            fmt::format("no difference from {} on", bytes_text(std::uint64_t(lossless)));
        plot.series.push_back({"no difference from here",
                               {{lossless, low, tooltip}, {lossless, high, tooltip}},
                               true});
    }
    return plot;
}

/// Name of a file for a function: its own where that is a plain word.
std::string file_name(const std::string& function, std::size_t index) {
    const bool plain = std::ranges::all_of(
        function, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; });
    return plain && !function.empty() ? function : fmt::format("function-{}", index + 1);
}

}  // namespace

std::vector<RatePlot> rate_plots(const RateDistortion& results) {
    std::vector<RatePlot> plots;
    const auto add = [&](const std::string& file, const std::string& title, RateFigure figure,
                         std::size_t function, double low, double high) {
        plots.push_back({file + ".svg", svg_file(plot_of(results, results.title + ": " + title,
                                                         figure, function, low, high))});
    };
    add("V", "V = 1 - exp(-T), mean of views", RateFigure::v_mean, 0, kLowestDb, kHighestDb);
    add("V-worst", "V, worst of the views", RateFigure::v_worst, 0, kLowestDb, kHighestDb);
    for (std::size_t f = 0; f < results.functions.size(); ++f)
        add(file_name(results.functions[f], f),
            fmt::format("by value, {}, mean of views", results.functions[f]), RateFigure::rgb_mean,
            f, kLowestDb, kHighestDb);
    add("voxels", "voxels", RateFigure::voxels, 0, 0, kHighestVoxelDb);
    return plots;
}

}  // namespace vog::evaluation
