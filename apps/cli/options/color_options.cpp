// color_options.cpp: colour options.
#include "options/color_options.h"

#include "shared/inputs.h"

namespace vog::cli {

void add_color_options(CLI::App& command, ColorArguments& arguments, const std::string& group,
                       const std::string& backgrounds) {
    command
        .add_option("--extinction", arguments.extinction,
                    "Factor on density, or auto: the 99th percentile of the non-zero T of the "
                    "first picture becomes 4")
        ->capture_default_str()
        ->group(group);
    std::string names;
    for (const std::string& name : transfer_function_names())
        names += (names.empty() ? "" : ", ") + name;
    command
        .add_option(
            "--tf", arguments.tf,
            "Transfer function on V = 1 - exp(-T): a JSON file (vog's or ParaView's) or one of " +
                names)
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--background", arguments.background,
                    "R,G,B in [0, 1], black, white or transparent" + backgrounds)
        ->capture_default_str()
        ->group(group);
    command
        .add_flag("--blend", arguments.blend,
                  "The paper's blend: colours fade into the background as V goes to 0")
        ->group(group);
}

std::optional<double> asked_extinction(const ColorArguments& arguments) {
    if (arguments.extinction == "auto") return std::nullopt;
    return parse_extinction(arguments.extinction);
}

ShadeOptions shading_of(const ColorArguments& arguments) {
    return {parse_background(arguments.background), arguments.blend};
}

}  // namespace vog::cli
