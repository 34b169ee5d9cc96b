// value_transfer_run.cpp: transfer functions by options, and notes on them.
#include "values/value_transfer_run.h"

#include <fmt/core.h>

#include <cmath>

#include "vog/error.h"

namespace vog::cli {

namespace {

/// throws  vog::Error for values that are all outside the data
void require_inside(const TransferRequest& request, const std::string& input,
                    const ValueData& data) {
    const auto require = [&](const std::string& option, double lower, double upper) {
        if (lower <= data.upper && upper > data.lower) return;
        throw Error(fmt::format("{}: {} is outside the data's values, {} to {}", input, option,
                                data.lower, data.upper));
    };
    if (const auto& window = request.window)
        require(fmt::format("--window {},{}", window->first, window->second),
                window->first - window->second / 2, HUGE_VAL);
    for (const ValueBand& band : request.bands)
        require(std::isinf(band.upper)
                    ? fmt::format("--iso {}", band.lower)
                    : fmt::format("the band from {} to {}", band.lower, band.upper),
                band.lower, band.upper);
}

TransferRequest request_of(const RenderArguments& arguments, const CLI::App& command) {
    const ValueArguments& given = arguments.value;
    TransferRequest request;
    request.window = window_of(given);
    request.bands = bands_of(given);
    request.threshold = given.threshold;
    request.unit_distance = given.unit_distance;
    request.may_be_empty = arguments.later_frame;
    if (const auto fixed = fixed_scale(arguments.quantity))
        request.range.emplace(fixed->low, fixed->high);
    if (arguments.quantity.fit() != ScaleFit::automatic)
        request.log = arguments.quantity.logarithmic();
    if (request.window || !request.bands.empty()) return request;
    request.points = transfer_points(arguments.color.tf);
    if (!request.points.at_values) return request;
    if (command.count("--range"))
        throw CLI::ValidationError(fmt::format(
            "--range: {} states values of its own, expected one of them", arguments.color.tf));
    request.range.reset();  // of an earlier picture of the sequence
    return request;
}

}  // namespace

ChosenTransfer transfer_of(const RenderArguments& arguments, const CLI::App& command,
                           const std::string& input, const ValueData& data,
                           std::vector<std::string>& notes) {
    const TransferRequest request = request_of(arguments, command);
    if (!request.may_be_empty) require_inside(request, input, data);
    ChosenTransfer chosen;
    try {
        chosen = choose_transfer(request, data);
    } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", input, error.what()));
    }
    const bool stated =
        !request.bands.empty() || (!request.window && !request.points.points.opacity.empty());
    if (stated && chosen.most_opacity > kMostOpacity)
        notes.push_back(fmt::format("opacity {} counts as {}: one of 1 is an infinite extinction",
                                    chosen.most_opacity, kMostOpacity));
    if (chosen.unit_distance == UnitDistance::of_map)
        notes.push_back(fmt::format(
            "an opacity ramp over the values that most of the mass has ({}--range {},{} "
            "--unit-distance {} repeats it)",
            chosen.scale.kind == ColorScale::Kind::log ? "--log " : "", chosen.scale.low,
            chosen.scale.high, chosen.transfer.unit_distance));
    return chosen;
}

}  // namespace vog::cli
