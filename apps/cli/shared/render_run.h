// render_run.h: load -> render -> shade -> image: what vog render and vog-mpi render share.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "options/camera_options.h"
#include "options/color_options.h"
#include "options/memory_options.h"
#include "shared/drawing.h"

namespace vog::cli {

struct RenderArguments {
    DrawingArguments drawing;
    ViewArguments view;
    ColorArguments color;
    MemoryArguments memory;
    std::string output, depth_output, size = "512x512";
    bool json = false, verbose = false;
    int threads = 0, repeat = 0;
    std::optional<Box> box;  ///< views look at this, not at what is drawn: one camera for many
};

/// Adds the options of `vog render`.
void add_render_options(CLI::App& command, RenderArguments& arguments);

/// Several who render together; alone by default.
struct RenderTogether {
    /// Reads this one's part of the inputs.
    std::function<Drawing(const DrawingArguments&, std::optional<double> extinction,
                          const CLI::App&)>
        load = load_drawing;
    bool writes = true;  ///< false: another one shades, writes and reports
    /// Of the inputs of a sequence, those that are this one's to draw, each by itself.
    std::function<std::vector<bool>(const std::vector<std::string>&)> mine{};
    std::function<Box(const Box&)> united{};                               ///< box of all
    std::function<double(double)> largest{};                               ///< number of all
    std::function<std::vector<std::string>(const std::string&)> gather{};  ///< texts of all
};
/// One picture. Prints what was made, unless JSON is asked for: which it returns.
nlohmann::ordered_json render(const RenderArguments& arguments, const CLI::App& command,
                              const RenderTogether& others = {});

/// Adds the subcommand.
void add_render(CLI::App& app, const std::shared_ptr<RenderArguments>& arguments,
                const RenderTogether& others);

}  // namespace vog::cli
