// picture_request.cpp: scales that several pictures share, and notes on chosen transfer functions.
#include "pictures/picture_request.h"

#include <fmt/core.h>

namespace vog::cli {

SharedScales scales_of(const Picture& picture) {
    return {picture.extinction, picture.scale.low, picture.scale.high,
            picture.made.chosen.transfer.unit_distance,
            picture.scale.kind == ColorScale::Kind::log ? 1.0 : 0.0};
}

void share(const SharedScales& scales, PictureRequest& request) {
    if (request.show == Show::depth) request.extinction = scales.extinction;
    request.transfer.may_be_empty = true;
    if (request.show == Show::volume) request.transfer.unit_distance = scales.unit_distance;
    const TransferRequest& transfer = request.transfer;
    const bool of_shares = request.show == Show::column || request.show == Show::deviation;
    if (request.show == Show::depth || transfer.range || (transfer.points.at_values && !of_shares))
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
        notes.push_back(
            fmt::format("opacity {} counts as {}, because 1 would be an infinite extinction",
                        chosen.most_opacity, kMostOpacity));
    if (chosen.unit_distance == UnitDistance::of_map)
        notes.push_back(
            fmt::format("opacity rises over the values that most of the mass has ({}--range {},{} "
                        "--unit-distance {} repeats it)",
                        chosen.scale.kind == ColorScale::Kind::log ? "--scale log " : "",
                        chosen.scale.low, chosen.scale.high, chosen.transfer.unit_distance));
    return notes;
}

std::vector<std::string> layer_notes(const ResolvedPicture& picture) {
    std::vector<std::string> notes;
    for (std::size_t n = 0; n < picture.layers.size(); ++n) {
        const ResolvedPicture& layer = picture.layers[n];
        if (layer.field.field.empty()) continue;  // hidden, or a surface
        const auto& [kind, low, high] = layer.chosen.scale;
        notes.push_back(
            fmt::format("layer {}: {}{}, values from {:.6g} to {:.6g}{}, unit distance {:.6g}",
                        n + 1, layer.field.field, layer.unit.empty() ? "" : " [" + layer.unit + "]",
                        low, high, kind == ColorScale::Kind::log ? ", logarithmic" : "",
                        layer.chosen.transfer.unit_distance));
    }
    return notes;
}

}  // namespace vog::cli
