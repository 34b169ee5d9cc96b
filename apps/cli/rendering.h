// rendering.h: load -> render -> shade -> image: what every command that makes a picture does.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
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
};

/// Adds the options of `vog render`.
void add_render_options(CLI::App& command, RenderArguments& arguments);

using LoadDrawing = std::function<Drawing(const DrawingArguments&, std::optional<double> extinction,
                                          const CLI::App&)>;
/// load    reads the inputs
/// writes  false: draws only, as one of several who make a picture together
void render(const RenderArguments& arguments, const CLI::App& command,
            const LoadDrawing& load = load_drawing, bool writes = true);

}  // namespace vog::cli
