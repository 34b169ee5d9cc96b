// picture_request.cpp: options to request, and scales that several pictures share.
#include "pictures/picture_request.h"

#include <fmt/core.h>

namespace vog::cli {

PictureRequest picture_request(const QuantityArguments& quantity, const ColorArguments& color,
                               const ValueArguments& value) {
    PictureRequest request;
    request.show = quantity.shown();
    request.field = quantity.field;
    request.fit = quantity.fit();
    request.least_column = quantity.least_column;
    request.unit = quantity.units;
    request.extinction = fixed_extinction(color);
    request.shading = shading_of(color);
    request.look = look_of(value);
    request.slabs = value.slabs;
    request.marks = {quantity.color_bar, quantity.axes, quantity.scale_bar, quantity.title};
    TransferRequest& transfer = request.transfer;
    if (const auto fixed = fixed_scale(quantity)) transfer.range.emplace(fixed->low, fixed->high);
    transfer.window = window_of(value);
    transfer.bands = bands_of(value);
    transfer.threshold = value.threshold;
    transfer.unit_distance = value.unit_distance;
    if (!color.tf.empty() && !transfer.window && transfer.bands.empty())
        transfer.points = transfer_points(color.tf);
    return request;
}

SharedScales scales_of(const Picture& picture) {
    return {picture.extinction, picture.scale.low, picture.scale.high,
            picture.made.chosen.transfer.unit_distance,
            picture.scale.kind == ColorScale::Kind::log ? 1.0 : 0.0};
}

void share(const SharedScales& scales, PictureRequest& request) {
    if (request.show == Show::depth) request.extinction = scales.extinction;
    request.transfer.may_be_empty = true;
    if (request.show == Show::volume) request.transfer.unit_distance = scales.unit_distance;
    if (request.show == Show::depth || request.transfer.range || request.transfer.points.at_values)
        return;
    request.transfer.range.emplace(scales.low, scales.high);
    request.fit = scales.log > 0 ? ScaleFit::log : ScaleFit::linear;
}

std::vector<std::string> transfer_notes(const PictureRequest& request,
                                        const ResolvedPicture& picture) {
    std::vector<std::string> notes;
    const TransferRequest& asked = request.transfer;
    const ChosenTransfer& chosen = picture.chosen;
    const bool stated =
        !asked.bands.empty() || (!asked.window && !asked.points.points.opacity.empty());
    if (stated && chosen.most_opacity > kMostOpacity)
        notes.push_back(fmt::format("opacity {} counts as {}: one of 1 is an infinite extinction",
                                    chosen.most_opacity, kMostOpacity));
    if (chosen.unit_distance == UnitDistance::of_map)
        notes.push_back(fmt::format(
            "an opacity ramp over the values that most of the mass has ({}--range {},{} "
            "--unit-distance {} repeats it)",
            chosen.scale.kind == ColorScale::Kind::log ? "--log " : "", chosen.scale.low,
            chosen.scale.high, chosen.transfer.unit_distance));
    return notes;
}

}  // namespace vog::cli
