// render.cpp: vog render: load -> render -> shade -> image; of one picture, or of one an input.
#include <fmt/core.h>

#include <filesystem>

#include "commands.h"
#include "rendering.h"
#include "sequence.h"
#include "vog/ply.h"
#include "vog/vdb.h"

namespace vog::cli {

namespace {

/// What views of an input look at, without its values where that is known without.
Box box_of(const DrawingArguments& arguments, const std::string& input, const CLI::App& command) {
    const FileKind kind = kind_of(input, arguments.volume.grid);
    if (kind == FileKind::model && input.ends_with(".ply")) return view_box(read_ply(input));
    const bool one_grid = arguments.volume.grid.find_first_of("*?") == std::string::npos;
    if (kind == FileKind::volume && input.ends_with(".vdb") && one_grid)
        return VdbReader(input, {arguments.volume.grid, arguments.volume.level_set_to_fog})
            .world_box();
    DrawingArguments one = arguments;
    one.inputs = {input};
    return load_drawing(one, {}, command).box;
}

/// A picture of each input: the same camera, and the extinction of the first.
nlohmann::ordered_json render_sequence(const RenderArguments& all, const CLI::App& command) {
    if (!all.depth_output.empty() && !is_sequence(all.depth_output))
        throw CLI::ValidationError("--depth-out takes a folder where -o does");
    const std::vector<Frame> frames = frames_of(all.drawing.inputs, all.output, ".png");
    const std::vector<Frame> depths = all.depth_output.empty()
                                          ? std::vector<Frame>{}
                                          : frames_of(all.drawing.inputs, all.depth_output, ".exr");
    RenderArguments one = all;
    one.box = Box{};
    for (const Frame& frame : frames) one.box->include(box_of(all.drawing, frame.input, command));
    nlohmann::ordered_json pictures = nlohmann::ordered_json::array();
    for (std::size_t n = 0; n < frames.size(); ++n) {
        one.drawing.inputs = {frames[n].input};
        one.output = frames[n].output;
        if (!depths.empty()) one.depth_output = depths[n].output;
        one.json = true;  // the extinction is in it
        const nlohmann::ordered_json made = render(one, command);
        const auto extinction = made.at("extinction").get<double>();
        one.color.extinction = fmt::format("{:.17g}", extinction);
        if (!all.json)
            fmt::print("{}: {}x{}, {:.1f} ms, extinction {:.6g}\n", one.output,
                       made.at("width").get<int>(), made.at("height").get<int>(),
                       made.at("render_ms").at("median").get<double>(), extinction);
        pictures.push_back(made);
    }
    return {{"output", all.output}, {"pictures", pictures}};
}

}  // namespace

void add_render(CLI::App& app) {
    auto arguments = std::make_shared<RenderArguments>();
    CLI::App* command =
        app.add_subcommand("render", "Render models, volumes or particles to a picture");
    add_render_options(*command, *arguments);
    command->callback([arguments, command] {
        RenderArguments all = *arguments;
        all.drawing.inputs = expanded(all.drawing.inputs);
        const nlohmann::ordered_json json =
            is_sequence(all.output) ? render_sequence(all, *command) : render(all, *command);
        if (all.json) fmt::print("{}\n", json.dump(2));
    });
}

}  // namespace vog::cli
