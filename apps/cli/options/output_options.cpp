// output_options.cpp: help and checks of the options that vog page, pack and export share.
#include "options/output_options.h"

#include <CLI/CLI.hpp>

#include "options/parser/settings.h"
#include "options/parser/validators.h"

namespace vog::cli {

void add_model_options(CLI::App& command, ModelArguments& arguments, const std::string& output) {
    command
        .add_option(
            "inputs", arguments.inputs,
            "Models (.ply, .vogz, sites); or volumes or particles, converted with the default "
            "options of vog convert. Quoted patterns match files in natural order: 'frame_*.ply'")
        ->required();
    command.add_option("-o,--output", arguments.output, output)->required();
    add_value(command, "--budget", arguments.budget, "[1, inf)",
              "Largest number of Gaussians per model; larger models are coarsened by joining "
              "neighbouring Gaussians");
    add_volume_options(command, arguments.volume);
    add_point_options(command, arguments.points);
    add_run_options(command, arguments.threads, arguments.json, arguments.verbose);
}

void add_no_fields_option(CLI::App& command, bool& no_fields) {
    command.add_flag("--no-fields", no_fields,
                     "Leave out fields: smaller files, but no values to show");
}

void add_page_options(CLI::App& command, PageArguments& arguments) {
    const OptionGroup grouped(command, kPageGroup);
    const auto add = [&](const std::string& name, auto& value, const std::string& text) {
        return command.add_option(name, value, text);
    };
    add("--title", arguments.title, "Title of the page; default: the name of the first model");
    add(setting("description"), arguments.description, "Text below the title");
    add("--name", arguments.names,
        "Name of a model in the page's selector; repeat once per model. Default: the file's name")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    command.add_flag(
        "--precise", arguments.precise,
        "Round numbers four times as finely, for 4 more bytes per Gaussian. Rims of opaque "
        "surfaces then differ by 2 of 255 from vog render's, otherwise by up to 10");
    command.add_flag("--steps,!--no-steps", arguments.steps,
                     "Treat the models as steps in time, with a play bar, one extinction and one "
                     "range for all. Default: yes if a single pattern names them");
    add_shown_options(command, arguments.words, kPageGroup);
    CLI::Option* background = command.get_option("--background");
    background->description(background->get_description() +
                            ", or system: black or white to match the reader's system theme");
}

void add_rounding_options(CLI::App& command, RoundingArguments& arguments) {
    const auto add = [&](const char* name, double& value, const std::string& text) {
        add_value(command, setting(name), value, "[1e-6, 0.5]", text);
    };
    add("rounding", arguments.step,
        "Relative step to which masses, shapes and means (in standard deviations) are rounded, "
        "1e-6 to 0.5; default 0.025");
    add("field-rounding", arguments.field_step,
        "Step to which field values are rounded, relative to the range of the data, 1e-6 to 0.5; "
        "default 1/256");
}

}  // namespace vog::cli
