// page_options.cpp: help and evaluation of the options of pages and sites.
#include "models/page_options.h"

#include <fmt/core.h>

#include "models/model_inputs.h"
#include "vog/shade.h"

namespace vog::cli {

PictureRequest page_request(const PageArguments& arguments) {
    RequestWords words = arguments.words;
    if (words.word("background") == "system") words.given.erase("background");
    return words.over();
}

HtmlOptions page_options(const PageArguments& arguments, const GivenOptions& command,
                         const HtmlModel& first, const std::string& input,
                         std::vector<std::string>& notes) {
    std::vector<std::string> found;
    HtmlOptions options =
        page_settings(page_request(arguments), first.levels.front(), input, found);
    options.title = command.has("--title") ? arguments.title : first.name;
    options.description = arguments.description;
    options.precise = arguments.precise;
    options.system_background = arguments.words.word("background") == "system";
    // Without an option for the view, every model of the page is framed by itself; the pages of a
    // sequence share one view.
    const bool viewed = arguments.subject.has_value() || view_given(command);
    if (viewed)
        options.camera =
            camera_from(arguments.view, command,
                        arguments.subject ? *arguments.subject : subject_of(first.levels[0]),
                        page_request(arguments), 1);
    options.steps = arguments.steps;
    if (arguments.chosen) {
        options.quantity = *arguments.chosen;
        return options;
    }
    print_notes(found);
    notes.insert(notes.end(), found.begin(), found.end());
    return options;
}

void check_page_options(const PageArguments& arguments, const GivenOptions& command) {
    const PictureRequest request = page_request(arguments);
    (void)html_quantity(request);
    if (view_given(command))
        camera_from(arguments.view, command, Box{{-1, -1, -1}, {1, 1, 1}}, request, 1);
}

void check_names(const PageArguments& arguments, std::size_t models) {
    if (!arguments.names.empty() && arguments.names.size() != models)
        throw UsageError(fmt::format("--name: {} names for {} models; give one name per model",
                                     arguments.names.size(), models));
}

std::string model_name(const PageArguments& arguments, const std::string& file, std::size_t n) {
    return arguments.names.empty() ? model_name(file) : arguments.names[n];
}

}  // namespace vog::cli
