// value_transfer_run.cpp: transfer functions from options, and the unit distance at which pictures are of use.
#include "values/value_transfer_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "vog/error.h"

namespace vog::cli {

namespace {

constexpr double kMeanOpacity = 0.6;  // of the covered pixels, for colour maps by name

/// Rounded to the digits that notes print, so that their flags repeat the picture.
double rounded(double value) { return std::stod(fmt::format("{:.4g}", value)); }

/// The unit distance at which the covered pixels' mean opacity is kMeanOpacity, from a few small pictures; none where
/// these show nothing. The optical depth of a pixel is proportional to 1 / unit distance: each picture gives all
/// depths, up to rounding where pixels are opaque.
std::optional<double> fitted_unit_distance(ValueTransfer transfer, const DrawByValue& draw,
                                           const Camera& camera, Size size) {
    constexpr int kEdge = 64, kMostPictures = 6;
    const double scale = double(kEdge) / std::max(size.width, size.height);
    const int width = std::max(1, static_cast<int>(std::lround(scale * size.width)));
    const int height = std::max(1, static_cast<int>(std::lround(scale * size.height)));
    for (int n = 0; n < kMostPictures; ++n) {
        const VolumeImage picture = draw(transfer, camera, width, height);
        std::vector<double> depths;  // times the unit distance
        for (const Rgba& pixel : picture.pixel)
            if (pixel.a > 0)
                depths.push_back(-std::log1p(-std::min(double{pixel.a}, 1 - 1e-6)) *
                                 transfer.unit_distance);
        if (depths.empty()) return std::nullopt;
        if (std::abs(mean_opacity(picture) - kMeanOpacity) < 1e-3) break;
        const auto mean_at = [&](double unit) {
            double sum = 0;
            for (const double depth : depths) sum -= std::expm1(-depth / unit);
            return sum / static_cast<double>(depths.size());
        };
        // Bisection of the logarithm: opacity falls with the unit distance.
        double low = std::log(transfer.unit_distance) - 40, high = low + 80;
        for (int step = 0; step < 60; ++step) {
            const double middle = 0.5 * (low + high);
            (mean_at(std::exp(middle)) > kMeanOpacity ? low : high) = middle;
        }
        transfer.unit_distance = std::exp(0.5 * (low + high));
    }
    return rounded(transfer.unit_distance);
}

/// throws  vog::Error for values that are all outside the data
void require_inside(const ValueData& data, const std::string& option, double lower, double upper) {
    if (lower <= data.upper && upper > data.lower) return;
    throw Error(fmt::format("{}: {} is outside the data's values, {} to {}", data.input, option,
                            data.lower, data.upper));
}

/// Points of --window, --band and --iso; none without these options.
std::optional<ValueTransfer> preset_of(const ValueArguments& given, const ValueData& data,
                                       bool checked, double unit_distance) {
    if (const auto window = window_of(given)) {
        const auto [center, width] = *window;
        if (checked) require_inside(data, "--window " + given.window, center - width / 2, HUGE_VAL);
        return window_transfer(center, width, unit_distance);
    }
    const std::vector<ValueBand> bands = bands_of(given);
    if (bands.empty()) return std::nullopt;
    for (const ValueBand& band : bands)
        if (checked)
            require_inside(data,
                           std::isinf(band.upper)
                               ? fmt::format("--iso {}", band.lower)
                               : fmt::format("the band from {} to {}", band.lower, band.upper),
                           band.lower, band.upper);
    return band_transfer(bands, unit_distance);
}

/// Range of values that shares are of: --range, else the data's.
std::pair<double, double> range_of(const RenderArguments& arguments, const ValueData& data) {
    if (const auto fixed = fixed_scale(arguments.quantity)) return {fixed->low, fixed->high};
    if (data.lower < data.upper) return {data.lower, data.upper};
    // Data of one value: from 0, which has no opacity, to that value.
    if (data.upper == 0) return {0, 1};
    return std::minmax(0.0, data.upper);
}

}  // namespace

double mean_opacity(const VolumeImage& picture) {
    double sum = 0;
    std::size_t covered = 0;
    for (const Rgba& pixel : picture.pixel) sum += double{pixel.a}, covered += pixel.a > 0;
    return covered ? sum / static_cast<double>(covered) : 0;
}

ChosenTransfer choose_transfer(const RenderArguments& arguments, const CLI::App& command,
                               const ValueData& data, const DrawByValue& draw, const Camera& camera,
                               Size size) {
    const ValueArguments& given = arguments.value;
    ChosenTransfer chosen;
    std::tie(chosen.lower, chosen.upper) = range_of(arguments, data);
    const double default_unit = given.unit_distance.value_or(rounded(data.diagonal / 100));
    const bool first = !arguments.later_frame;
    bool fits = false;                   // whether the unit distance is found by pictures
    bool stated = !given.bands.empty();  // whether opacities are the user's
    if (auto preset = preset_of(given, data, first, default_unit)) {
        chosen.transfer = std::move(*preset);
    } else {
        const TransferPoints points = transfer_points(arguments.color.tf);
        if (points.at_values && command.count("--range"))
            throw CLI::ValidationError(fmt::format(
                "--range: {} states values of its own, expected one of them", arguments.color.tf));
        if (points.at_values) chosen.lower = points.lower, chosen.upper = points.upper;
        chosen.transfer = over_range(points, chosen.lower, chosen.upper, default_unit);
        if (given.unit_distance) chosen.transfer.unit_distance = *given.unit_distance;
        stated = !points.points.opacity.empty();
        fits = !stated && !points.has_unit_distance && !given.unit_distance;
    }
    if (given.threshold) chosen.transfer = above(std::move(chosen.transfer), *given.threshold);
    const double most = most_opacity(chosen.transfer, data.lower, data.upper);
    if (first && !(most > 0))
        throw Error(
            fmt::format("{}: the transfer function shows none of the data's values, {} to {}",
                        data.input, data.lower, data.upper));
    if (stated && most > kMostOpacity)
        chosen.notes.push_back(fmt::format(
            "opacity {} counts as {}: one of 1 is an infinite extinction", most, kMostOpacity));
    if (fits) {
        const auto fitted = fitted_unit_distance(chosen.transfer, draw, camera, size);
        if (fitted) chosen.transfer.unit_distance = *fitted;
        chosen.notes.push_back(
            fmt::format("an opacity ramp over the values, its unit distance {} (--range {},{} "
                        "--unit-distance {} repeats it)",
                        fitted ? fmt::format("set for a mean opacity of {}", kMeanOpacity)
                               : "a hundredth of the diagonal, since small pictures show nothing",
                        chosen.lower, chosen.upper, chosen.transfer.unit_distance));
    }
    return chosen;
}

}  // namespace vog::cli
