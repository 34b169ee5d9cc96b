// page_options.cpp: help and evaluation of the options of pages and sites.
#include "models/page_options.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "shared/inputs.h"
#include "shared/validators.h"
#include "vog/shade.h"
#include "vog/site.h"
#include "vog/text.h"

namespace vog::cli {

void add_page_options(CLI::App& command, PageArguments& arguments) {
    const OptionGroup grouped(command, kPageGroup);
    const auto add = [&](const std::string& name, auto& value, const std::string& text) {
        return command.add_option(name, value, text);
    };
    add("--title", arguments.title, "Title of the page; default: the name of the first model");
    add("--description", arguments.description, "Text below the title");
    add("--name", arguments.names,
        "Name of a model in the page's selector; repeat once per model. Default: the file's name")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    command.add_flag(
        "--precise", arguments.precise,
        "Numbers four times as fine, for 4 bytes more a Gaussian: rims "
        "of opaque surfaces differ by 2 of 255 from vog render's, else by up to 10. Of a site: "
        "as fine as a page without this option");
    add_page_quantity_options(command, arguments.quantity, kPageGroup);
    add("--scale", arguments.quantity.quantity.scale,
        "Colour scale: linear, log or auto, which for volume is log where most of the mass has "
        "values "
        "over a decade and more, else linear")
        ->check(CLI::IsMember({"auto", "linear", "log"}))
        ->capture_default_str();
    command.add_flag(
        "--steps,!--no-steps", arguments.steps,
        "Whether the models are steps in time, with a play bar, one extinction and one "
        "range for all; default: where a single pattern names them");
    add_color_options(command, arguments.color, kPageGroup,
                      ", or system: black or white by the reader's colour scheme");
}

HtmlOptions page_options(const PageArguments& arguments, const CLI::App& command,
                         const HtmlModel& first, const std::string& input,
                         std::vector<std::string>& notes) {
    HtmlOptions options;
    options.title = command.count("--title") ? arguments.title : first.name;
    options.description = arguments.description;
    options.precise = arguments.precise;
    // A file of values is of volume; the other quantities then have the default colours.
    const Show show = arguments.quantity.quantity.shown();
    const std::string map = map_of(arguments.color, show);
    const bool by_value =
        show == Show::volume && !std::ranges::count(transfer_function_names(), map);
    options.tf = load_transfer_function(by_value ? default_map(show) : map);
    options.extinction = fixed_extinction(arguments.color);
    ColorArguments color = arguments.color;
    options.system_background = color.background == "system";
    if (options.system_background) color.background = ColorArguments{}.background;
    options.shading = shading_of(color);
    // Without an option for the view, every model of the page is framed by itself; the pages of a
    // sequence share one view.
    const bool viewed = arguments.subject.has_value() || view_given(command);
    if (viewed)
        options.camera =
            camera_from(arguments.view, command,
                        arguments.subject ? *arguments.subject : subject_of(first.levels[0]), 1);
    options.steps = arguments.steps;
    if (arguments.chosen) {
        options.quantity = *arguments.chosen;
        return options;
    }
    std::vector<std::string> found;
    options.quantity = page_quantity(arguments.quantity, color, first.levels.front(), input, found);
    print_notes(found);
    notes.insert(notes.end(), found.begin(), found.end());
    return options;
}

void check_page_options(const PageArguments& arguments, const CLI::App& command) {
    stated_quantity(arguments.quantity);
    const Show show = arguments.quantity.quantity.shown();
    if (show != Show::volume) load_transfer_function(map_of(arguments.color, show));
    fixed_extinction(arguments.color);
    if (view_given(command)) camera_from(arguments.view, command, Box{{-1, -1, -1}, {1, 1, 1}}, 1);
}

void check_names(const PageArguments& arguments, std::size_t models) {
    if (!arguments.names.empty() && arguments.names.size() != models)
        throw CLI::ValidationError(fmt::format("--name: {} names for {} models, expected one each",
                                               arguments.names.size(), models));
}

std::string model_name(const PageArguments& arguments, const std::string& file, std::size_t n) {
    if (!arguments.names.empty()) return arguments.names[n];
    if (const auto site = find_site(file))
        return read_site_info(site->folder).models[site->model].name;
    return printable(std::filesystem::path(file).stem().string());
}

}  // namespace vog::cli
