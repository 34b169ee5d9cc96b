// page_quantity.cpp: help and evaluation of the options of a page's first quantity.
#include "values/page_quantity.h"

#include <fmt/core.h>

#include "shared/drawing.h"
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
    QuantityArguments& quantity = arguments.quantity;
    command
        .add_option("--show", quantity.show,
                    "Quantity that is shown first: T, column (column density), mean or "
                    "deviation of --field along the ray, volume: emission and absorption by the "
                    "value of --field under --tf, --window, --band or --iso; or maximum: the "
                    "largest value of --field along the ray")
        ->check(CLI::IsMember({"T", "column", "mean", "deviation", "volume", "maximum"}))
        ->capture_default_str();
    command.add_option(
        "--field", quantity.field,
        "Field that mean, deviation, volume and maximum show first: temperature, velocity (the "
        "component along the view), velocity.x, .y or .z, velocity.magnitude (root "
        "mean square, mean "
        "alone); default: the first one; "
        "of volume and maximum the density itself where the model has it");
    command.add_option(
        "--range", quantity.range,
        "Values LO,HI at the two ends of --tf; default: of the first view; volume: of "
        "the data");
    command.add_flag("--log", quantity.log,
                     "Logarithmic colours of column, mean, deviation or maximum");
    command.add_option("--clip", arguments.clip,
                       "Box of the world that is shown first, x0,y0,z0,x1,y1,z1");
    command
        .add_option("--clip-plane", arguments.clip_planes,
                    fmt::format("Plane nx,ny,nz,d that first cuts off its side behind: a point x "
                                "of the world is shown where n.x >= d; may be given again, {} "
                                "times at most",
                                kMostHtmlPlanes))
        ->allow_extra_args(false);
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
    DrawingArguments clip;
    clip.clip_box = arguments.clip;
    clip.clip_planes = arguments.clip_planes;
    quantity.look.clip = clip_of(clip);
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
