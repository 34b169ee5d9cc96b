// page_quantity.cpp: first settings of a page or a window, from a request.
#include "models/page_quantity.h"

#include "pictures/picture_request.h"
#include "pictures/scene_inputs.h"

namespace vog::cli {

ValueTransfer stated_transfer(PictureRequest request, const Gaussians& model,
                              const ScalarField& field, std::vector<std::string>& notes) {
    request.show = Show::volume;
    request.field = field.name;
    const ResolvedPicture picture = resolve(
        request, scene_of(std::shared_ptr<const Gaussians>(std::shared_ptr<void>(), &model)));
    const std::vector<std::string> lines = transfer_notes(request, picture);
    notes.insert(notes.end(), lines.begin(), lines.end());
    return picture.chosen.transfer;
}

HtmlOptions page_settings(PictureRequest request, const Gaussians& model, const std::string& input,
                          std::vector<std::string>& notes) {
    if (is_by_value(request.show)) {
        const ScalarField& shown =
            scalar_field_of(model.fields, request.field, input, request.show);
        if (request.show == Show::volume) request.field = shown.name;
    }
    ResolvedPicture volume;
    HtmlOptions options = html_options(request, model, &volume);
    if (request.show == Show::volume) notes = transfer_notes(request, volume);
    return options;
}

}  // namespace vog::cli
