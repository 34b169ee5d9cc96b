// render.cpp: vog render: load -> render -> shade -> image; of one picture, or of one an input.
#include <fmt/core.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "shared/render_run.h"
#include "shared/sequence.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

void print(const Json& made) {
    fmt::print("{}: {}x{}, {:.1f} ms, extinction {:.6g}\n", made.at("output").get<std::string>(),
               made.at("width").get<int>(), made.at("height").get<int>(),
               made.at("render_ms").at("median").get<double>(),
               made.at("extinction").get<double>());
}

/// Of all frames what was made of them, in their order, from those that each has drawn.
Json pictures_of(const std::vector<Frame>& frames, const std::vector<std::string>& drawn) {
    std::map<std::string, Json> by_output;
    for (const std::string& text : drawn)
        for (const Json& made : Json::parse(text)) by_output[made.at("output")] = made;
    Json pictures = Json::array();
    for (const Frame& frame : frames) pictures.push_back(by_output.at(frame.output));
    return pictures;
}

/// A picture of each input: one camera, of all boxes, and the extinction of the first picture.
Json render_sequence(const RenderArguments& all, const CLI::App& command,
                     const RenderTogether& others) {
    if (!all.depth_output.empty() && !is_sequence(all.depth_output))
        throw CLI::ValidationError("--depth-out takes a folder where -o does");
    const std::vector<std::string>& inputs = all.drawing.inputs;
    const std::vector<Frame> frames = frames_of(inputs, all.output, ".png");
    const std::vector<Frame> depths = all.depth_output.empty()
                                          ? std::vector<Frame>{}
                                          : frames_of(inputs, all.depth_output, ".exr");
    const std::vector<bool> mine =
        others.mine ? others.mine(inputs) : std::vector<bool>(frames.size(), true);
    RenderArguments one = all;
    Box box;
    for (std::size_t n = 0; n < frames.size(); ++n)
        if (mine[n]) box.include(box_of(inputs[n], all.drawing.volume, all.drawing.points));
    one.box = others.united ? others.united(box) : box;
    one.json = true;  // the extinction is in it
    if (!others.writes) one.view.save_camera.clear();
    Json drawn = Json::array();
    for (std::size_t n = 0; n < frames.size(); ++n) {
        double extinction = 0;
        if (mine[n]) {
            one.drawing.inputs = {frames[n].input};
            one.output = frames[n].output;
            if (!depths.empty()) one.depth_output = depths[n].output;
            drawn.push_back(render(one, command));
            extinction = drawn.back().at("extinction");
            if (!all.json && !others.gather) print(drawn.back());
        }
        if (n > 0) continue;
        if (others.largest) extinction = others.largest(extinction);
        one.color.extinction = fmt::format("{:.17g}", extinction);
    }
    const Json pictures = pictures_of(
        frames, others.gather ? others.gather(drawn.dump()) : std::vector{drawn.dump()});
    if (!all.json && others.gather && others.writes)
        for (const Json& made : pictures) print(made);
    return {{"output", all.output}, {"pictures", pictures}};
}

}  // namespace

void add_render(CLI::App& app) { add_render(app, std::make_shared<RenderArguments>(), {}); }

void add_render(CLI::App& app, const std::shared_ptr<RenderArguments>& arguments,
                const RenderTogether& others) {
    CLI::App* command =
        app.add_subcommand("render", "Render models, volumes or particles to a picture");
    add_render_options(*command, *arguments);
    command->callback([arguments, command, others] {
        RenderArguments all = *arguments;
        all.drawing.inputs = expanded(all.drawing.inputs);
        const AskedMemory memory(all.memory);
        const Json json = is_sequence(all.output) ? render_sequence(all, *command, others)
                                                  : render(all, *command, others);
        if (all.json && others.writes) fmt::print("{}\n", json.dump(2));
    });
}

}  // namespace vog::cli
