// page_quantity.cpp: help and evaluation of the options of a page's first quantity.
#include "models/page_quantity.h"

#include <fmt/core.h>

#include "pictures/picture_request.h"
#include "pictures/scene_inputs.h"
#include "shared/validators.h"
#include "vog/field_maps.h"
#include "vog/periodic.h"

namespace vog::cli {

ValueTransfer stated_transfer(const PageQuantityArguments& arguments, const ColorArguments& color,
                              const Gaussians& model, const ScalarField& field,
                              std::vector<std::string>& notes) {
    QuantityArguments quantity = arguments.quantity;
    quantity.show = word_of(Show::volume);
    PictureRequest request = picture_request(quantity, color, arguments.value);
    request.field = field.name;
    const ResolvedPicture picture = resolve(
        request, scene_of(std::shared_ptr<const Gaussians>(std::shared_ptr<void>(), &model)));
    const std::vector<std::string> lines = transfer_notes(request, picture);
    notes.insert(notes.end(), lines.begin(), lines.end());
    return picture.chosen.transfer;
}

void add_page_quantity_options(CLI::App& command, PageQuantityArguments& arguments,
                               const std::string& group) {
    const OptionGroup grouped(command, group);
    add_shown_options(command, arguments.quantity);
    add_clip_options(command, arguments);
    add_value_options(command, arguments.value);
}

HtmlQuantity stated_quantity(const PageQuantityArguments& arguments) {
    const QuantityArguments& given = arguments.quantity;
    check_value_options(arguments.value);
    HtmlQuantity quantity;
    quantity.show = given.show;
    quantity.field = given.field;
    quantity.look = look_of(arguments.value);
    if (arguments.value.slabs)
        (given.shown() == Show::maximum ? quantity.maximum_slabs : quantity.slabs) =
            *arguments.value.slabs;
    quantity.look.clip = clip_of(arguments);
    if (quantity.look.clip.planes.size() > kMostHtmlPlanes)
        throw CLI::ValidationError(fmt::format("--clip-plane: {} planes, expected at most {}",
                                               quantity.look.clip.planes.size(), kMostHtmlPlanes));
    if (given.shown() != Show::volume) quantity.scale = fixed_scale(given);
    quantity.log = given.logarithmic();
    return quantity;
}

HtmlQuantity page_quantity(const PageQuantityArguments& arguments, const ColorArguments& color,
                           const Gaussians& model, const std::string& input,
                           std::vector<std::string>& notes) {
    HtmlQuantity quantity = stated_quantity(arguments);
    quantity.look.clip = inside_period(quantity.look.clip, model);
    const Show show = arguments.quantity.shown();
    if (!is_by_value(show)) return quantity;
    const ScalarField& field = scalar_field_of(model.fields, quantity.field, input, show);
    if (show == Show::maximum) return quantity;
    quantity.field = field.name;
    quantity.transfer = stated_transfer(arguments, color, model, field, notes);
    return quantity;
}

}  // namespace vog::cli
