// page_request.cpp: first settings of a page from a picture's request.
#include <fmt/core.h>

#include "render/picture/request/request_effects.h"
#include "shade/values/unit_range.h"
#include "vog/export_html.h"
#include "vog/periodic.h"
#include "vog/picture.h"

namespace vog {

HtmlQuantity html_quantity(const PictureRequest& request) {
    if (request.fit == ScaleFit::symmetric)
        throw RequestError("scale", " symmetric: a page or a window has linear, log and auto");
    HtmlQuantity quantity;
    quantity.show = word_of(request.show);
    quantity.field = request.field;
    quantity.look = request.look;
    if (request.slabs)
        request.show == Show::maximum ? quantity.maximum_slabs = *request.slabs
                                      : quantity.slabs.emplace(*request.slabs);
    quantity.look.clip = request.options.clip;
    if (const std::size_t planes = quantity.look.clip.planes.size(); planes > kMostHtmlPlanes)
        throw RequestError("clip_planes", fmt::format(": {} planes, expected at most {}", planes,
                                                      kMostHtmlPlanes));
    quantity.fit = request.fit;
    if (request.show == Show::volume) return quantity;
    quantity.scale = stated_scale(request);
    if (const auto& scale = quantity.scale;
        scale && scale->kind == ColorScale::Kind::log && !(scale->low > 0))
        throw RequestError("range", fmt::format(" {},{}: expected values above 0 with `scale` log",
                                                scale->low, scale->high));
    return quantity;
}

HtmlOptions html_options(const PictureRequest& request, const Gaussians& model,
                         ResolvedPicture* volume) {
    HtmlOptions options;
    options.camera = request.camera;
    options.extinction = request.extinction;
    options.shading = request.shading;
    HtmlQuantity& quantity = options.quantity = html_quantity(request);
    // Points at values of a volume are not those of other quantities, which then have the default colours.
    const TransferPoints& map = request.transfer.points;
    options.tf = (map.at_values && !quantity.scale) || map.points.color.empty()
                     ? named_transfer_function(default_map(request.show))
                     : shading::over_unit_range(map);
    quantity.look.clip = inside_period(quantity.look.clip, model);
    if (request.show != Show::volume) return options;
    PictureRequest one = request;
    if (one.field.empty())
        if (const ScalarField* field = scalar_to_begin_with(model.fields)) one.field = field->name;
    if (one.field.empty()) return options;  // which write_html refuses
    const ResolvedPicture picture =
        resolve(one, scene_of(std::shared_ptr<const Gaussians>(std::shared_ptr<void>(), &model)));
    quantity.field = picture.field.field;
    quantity.transfer = picture.chosen.transfer;
    if (volume) *volume = picture;
    return options;
}

}  // namespace vog
