// color_options.cpp: help and evaluation of the colour options.
#include "options/color_options.h"

#include <fmt/core.h>

#include "shared/inputs.h"
#include "shared/validators.h"

namespace vog::cli {

void add_color_options(CLI::App& command, ColorArguments& arguments, const std::string& group,
                       const std::string& backgrounds) {
    const OptionGroup grouped(command, group);
    command
        .add_option(
            "--extinction", arguments.extinction,
            "Extinction, the factor on density in the optical depth T, or auto: the value at "
            "which the 99th percentile of the first picture's non-zero T is 4")
        ->capture_default_str();
    std::string names;
    for (const std::string& name : transfer_function_names())
        names += (names.empty() ? "" : ", ") + name;
    command.add_option(
        "--tf", arguments.tf,
        fmt::format("Transfer function from V = 1 - exp(-T) to colour: a JSON file (of "
                    "vog or ParaView) or one of {}. Default: {}, of maps {}",
                    names, default_map(Show::depth), default_map(Show::column)));
    command
        .add_option("--background", arguments.background,
                    "Background colour: R,G,B in [0, 1], black, white or transparent" + backgrounds)
        ->capture_default_str();
    command.add_flag(
        "--blend", arguments.blend,
        "Blend colours with the background by V, as the paper does: they fade out as V goes "
        "to 0");
}

std::string map_of(const ColorArguments& arguments, Show show) {
    return arguments.tf.empty() ? default_map(show) : arguments.tf;
}

std::optional<double> fixed_extinction(const ColorArguments& arguments) {
    if (arguments.extinction == "auto") return std::nullopt;
    return parse_extinction(arguments.extinction);
}

ShadeOptions shading_of(const ColorArguments& arguments) {
    return {parse_background(arguments.background), arguments.blend};
}

}  // namespace vog::cli
