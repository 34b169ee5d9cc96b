// color_options.h: options from optical depth T to colour, of render, view and export.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "vog/picture.h"

namespace vog::cli {

struct ColorArguments {
    std::string extinction = "auto", tf, background = "black";
    bool blend = false;
};

/// Adds --extinction, --tf, --background and --blend.
/// backgrounds  further values of --background, for its help
void add_color_options(CLI::App& command, ColorArguments& arguments,
                       const std::string& group = "Colour", const std::string& backgrounds = "");

/// --tf, or the default map of a quantity.
std::string map_of(const ColorArguments& arguments, Show show);
/// The number of --extinction; none for auto. throws CLI::ValidationError for other texts
std::optional<double> fixed_extinction(const ColorArguments& arguments);
/// Shading by --background and --blend. throws CLI::ValidationError for an unknown background
ShadeOptions shading_of(const ColorArguments& arguments);

}  // namespace vog::cli
