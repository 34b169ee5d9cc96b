// rate_figures.cpp: figures of rows, and bytes of a series at a given figure.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "vog/error.h"
#include "vog/rate_distortion.h"

namespace vog {

namespace {

double mean_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Whether rows of a series are points of one curve.
bool is_graded(const RateRow& row) { return row.tolerance > 0 || row.gaussians > 0; }

}  // namespace

std::optional<double> rate_figure(const RateRow& row, RateFigure figure, std::size_t function) {
    switch (figure) {
        case RateFigure::v_mean:
            return mean_of(row.psnr_v_db);
        case RateFigure::v_worst:
            return std::ranges::min(row.psnr_v_db);
        case RateFigure::v_axes:
            return mean_of(std::span(row.psnr_v_db).subspan(1));
        case RateFigure::v_paper:
            return row.psnr_v_db.front();
        case RateFigure::voxels:
            return row.voxels.psnr_db;
        case RateFigure::rgb_mean:
        case RateFigure::rgb_worst:
            break;
    }
    if (row.psnr_rgb_db.empty()) return std::nullopt;
    const std::vector<double>& views = row.psnr_rgb_db.at(function);
    return figure == RateFigure::rgb_mean ? mean_of(views) : std::ranges::min(views);
}

std::optional<double> bytes_at(const RateDistortion& results, const std::string& series,
                               RateFigure figure, double decibels, std::size_t function) {
    std::vector<std::pair<double, double>> points;  // bytes, dB
    bool graded = true;
    for (const RateRow& row : results.rows) {
        const std::optional<double> value = rate_figure(row, figure, function);
        if (row.series != series || !value) continue;
        points.emplace_back(static_cast<double>(row.bytes), *value);
        graded = graded && is_graded(row);
    }
    std::ranges::sort(points);
    for (std::size_t n = 0; n < points.size(); ++n) {
        const auto [bytes, value] = points[n];
        if (value < decibels) continue;
        // All before are below.
        if (n == 0 || !graded || std::isinf(value)) return bytes;
        const auto [bytes_before, before] = points[n - 1];
        const double share = (decibels - before) / (value - before);
        return std::exp(std::lerp(std::log(bytes_before), std::log(bytes), share));
    }
    return std::nullopt;
}

std::vector<std::string> rate_series(const RateDistortion& results) {
    std::vector<std::string> names;
    for (const RateRow& row : results.rows)
        if (std::ranges::find(names, row.series) == names.end()) names.push_back(row.series);
    return names;
}

bool is_model_series(const std::string& series) { return series.starts_with("model"); }

}  // namespace vog
