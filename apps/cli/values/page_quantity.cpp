// page_quantity.cpp: help and evaluation of the options of a page's first quantity.
#include "values/page_quantity.h"

#include <fmt/core.h>

#include "shared/validators.h"
#include "values/value_inputs.h"
#include "values/value_transfer_run.h"
#include "vog/field_maps.h"

namespace vog::cli {

ValueTransfer stated_transfer(const PageQuantityArguments& arguments, const ColorArguments& color,
                              const CLI::App& command, const Gaussians& model,
                              const ScalarField& field, const std::string& input,
                              std::vector<std::string>& notes) {
    RenderArguments run;
    run.color = color;
    run.quantity = arguments.quantity;
    run.value = arguments.value;
    return transfer_of(run, command, input, value_data(model, field), notes).transfer;
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
        (given.maximum() ? quantity.maximum_slabs : quantity.slabs) = *arguments.value.slabs;
    quantity.look.clip = clip_of(arguments);
    if (quantity.look.clip.planes.size() > kMostHtmlPlanes)
        throw CLI::ValidationError(fmt::format("--clip-plane: {} planes, expected at most {}",
                                               quantity.look.clip.planes.size(), kMostHtmlPlanes));
    if (!given.volume()) quantity.scale = fixed_scale(given);
    quantity.log = given.logarithmic();
    return quantity;
}

HtmlQuantity page_quantity(const PageQuantityArguments& arguments, const ColorArguments& color,
                           const CLI::App& command, const Gaussians& model,
                           const std::string& input, std::vector<std::string>& notes) {
    HtmlQuantity quantity = stated_quantity(arguments);
    if (arguments.quantity.maximum())
        (void)scalar_field_of(model.fields, quantity.field, input, quantity.show);
    if (!arguments.quantity.volume()) return quantity;
    const ScalarField& field = scalar_field_of(model.fields, quantity.field, input, quantity.show);
    quantity.field = field.name;
    quantity.transfer = stated_transfer(arguments, color, command, model, field, input, notes);
    return quantity;
}

}  // namespace vog::cli
