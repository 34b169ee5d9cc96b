// shown_request.cpp: quantity, colours and camera of the window as a request.
#include "quantity/shown_request.h"

namespace vog::viewer {

PictureRequest request_of(const Quantity& quantity, const Look& look, const Camera& camera,
                          const ColorScale& scale, const ValueTransfer* transfer, int width,
                          int height) {
    PictureRequest request;
    const Show show = request.show = quantity.show;
    request.camera = camera;
    request.width = width, request.height = height;
    request.options.clip = quantity.look.clip;
    request.shading.background = look.shading.background;
    if (of_field(show)) request.field = text_of(quantity.field);
    if (is_by_value(show)) request.slabs = quantity.slabs;
    if (show == Show::volume) {
        if (transfer) request.transfer.points = transfer_points(*transfer);
        request.look = quantity.look;
        return request;
    }
    // Maps have no range of visibility.
    request.transfer.points =
        transfer_points(show == Show::depth ? transfer_function(look) : map_function(look));
    if (show == Show::depth) {
        request.extinction = look.extinction;
        request.shading.blend = look.shading.blend;
    } else {
        request.transfer.range.emplace(scale.low, scale.high);
        request.fit = scale.kind == ColorScale::Kind::log ? ScaleFit::log : ScaleFit::linear;
    }
    return request;
}

}  // namespace vog::viewer
