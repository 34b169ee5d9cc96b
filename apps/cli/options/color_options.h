// color_options.h: how T becomes colour: the options that render, view and export share.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "vog/shade.h"

namespace vog::cli {

struct ColorArguments {
    std::string extinction = "auto", tf = "inferno", background = "black";
    bool blend = false;
};

/// Adds --extinction, --tf, --background and --blend.
/// backgrounds  what --background takes besides, for its help
void add_color_options(CLI::App& command, ColorArguments& arguments,
                       const std::string& group = "Colour", const std::string& backgrounds = "");

/// The number of --extinction; none for auto.
/// throws CLI::ValidationError for anything else
std::optional<double> asked_extinction(const ColorArguments& arguments);
/// --background and --blend. throws CLI::ValidationError
ShadeOptions shading_of(const ColorArguments& arguments);

}  // namespace vog::cli
