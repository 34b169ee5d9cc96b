// page_quantity.cpp: the first quantity of a page or a window, from a request.
#include "models/page_quantity.h"

#include <fmt/core.h>

#include "pictures/picture_request.h"
#include "pictures/scene_inputs.h"
#include "vog/periodic.h"

namespace vog::cli {

HtmlQuantity stated_quantity(const PictureRequest& request) {
    if (request.fit == ScaleFit::symmetric)
        throw UsageError("--scale symmetric: a page or a window has linear, log and auto");
    HtmlQuantity quantity;
    quantity.show = word_of(request.show);
    quantity.field = request.field;
    quantity.look = request.look;
    if (request.slabs)
        request.show == Show::maximum ? quantity.maximum_slabs = *request.slabs
                                      : quantity.slabs.emplace(*request.slabs);
    quantity.look.clip = request.options.clip;
    if (quantity.look.clip.planes.size() > kMostHtmlPlanes)
        throw UsageError(fmt::format("--clip: {} planes, expected at most {}",
                                     quantity.look.clip.planes.size(), kMostHtmlPlanes));
    quantity.fit = request.fit;
    const bool log = request.fit == ScaleFit::log;
    using Kind = ColorScale::Kind;
    if (const auto& range = request.transfer.range; range && request.show != Show::volume)
        quantity.scale = {log ? Kind::log : Kind::linear, range->first, range->second};
    if (log && quantity.scale && !(quantity.scale->low > 0))
        throw UsageError(fmt::format("--range {},{}: expected values above 0 with --scale log",
                                     quantity.scale->low, quantity.scale->high));
    return quantity;
}

ValueTransfer stated_transfer(PictureRequest request, const Gaussians& model,
                              const ScalarField& field, std::vector<std::string>& notes) {
    request.show = Show::volume;
    request.field = field.name;
    request.options.clip = {};
    const ResolvedPicture picture = resolve(
        request, scene_of(std::shared_ptr<const Gaussians>(std::shared_ptr<void>(), &model)));
    const std::vector<std::string> lines = transfer_notes(request, picture);
    notes.insert(notes.end(), lines.begin(), lines.end());
    return picture.chosen.transfer;
}

HtmlQuantity page_quantity(const PictureRequest& request, const Gaussians& model,
                           const std::string& input, std::vector<std::string>& notes) {
    HtmlQuantity quantity = stated_quantity(request);
    quantity.look.clip = inside_period(quantity.look.clip, model);
    if (!is_by_value(request.show)) return quantity;
    const ScalarField& field = scalar_field_of(model.fields, quantity.field, input, request.show);
    if (request.show == Show::maximum) return quantity;
    quantity.field = field.name;
    quantity.transfer = stated_transfer(request, model, field, notes);
    return quantity;
}

}  // namespace vog::cli
