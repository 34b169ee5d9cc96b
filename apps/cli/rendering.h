// rendering.h: load -> render -> shade -> image: what every command that makes a picture does.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "color.h"
#include "drawing.h"
#include "view.h"

namespace vog::cli {

struct RenderArguments {
    DrawingArguments drawing;
    ViewArguments view;
    ColorArguments color;
    std::string output, depth_output, size = "512x512";
    bool json = false, verbose = false;
    int threads = 0, repeat = 0;
    std::optional<Box> box;  ///< views look at this, not at what is drawn: one camera for many
};

/// Adds the options of `vog render`.
void add_render_options(CLI::App& command, RenderArguments& arguments);

using LoadDrawing = std::function<Drawing(const DrawingArguments&, std::optional<double> extinction,
                                          const CLI::App&)>;
/// Prints what was made, unless JSON is asked for: which it returns.
/// load    reads the inputs
/// writes  false: draws only, as one of several who make a picture together
nlohmann::ordered_json render(const RenderArguments& arguments, const CLI::App& command,
                              const LoadDrawing& load = load_drawing, bool writes = true);

}  // namespace vog::cli
