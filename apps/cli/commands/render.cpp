// render.cpp: vog render: load -> render -> shade -> image, for one picture or one per input.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "shared/outputs.h"
#include "shared/render_run.h"
#include "shared/sequence.h"
#include "shared/terminal.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

/// Report of one picture of a sequence: a line of text and JSON.
struct PictureReport {
    std::size_t frame = 0;
    std::string line;
    Json json;
};
PictureReport report_of(std::size_t frame, const RenderedPicture& picture) {
    return {frame,
            fmt::format("{}: {}x{}, {:.1f} ms, {}", picture.output, picture.width, picture.height,
                        picture.median_ms(),
                        picture.unit_distance
                            ? fmt::format("mean opacity {:.3f} where covered", picture.mean_opacity)
                        : picture.scale ? fmt::format("{:.1f} % of the pixels above the range",
                                                      100 * picture.above_range)
                                        : fmt::format("extinction {:.6g}", picture.extinction)),
            to_json(picture)};
}

/// Every rank's reports, on every rank. They travel as JSON text, because MPI exchanges bytes
/// between processes and the reports hold lists of any length; within a process nothing is parsed.
std::vector<PictureReport> allgather(const std::vector<PictureReport>& own,
                                     const RenderRanks& ranks) {
    if (!ranks.allgather) return own;
    Json sent = Json::array();
    for (const PictureReport& report : own)
        sent.push_back(Json::array({report.frame, report.line, report.json}));
    std::vector<PictureReport> all;
    for (const std::string& text : ranks.allgather(json_line(sent)))
        for (const Json& report : Json::parse(text))
            all.push_back({report[0].get<std::size_t>(), report[1].get<std::string>(), report[2]});
    return all;
}

/// The camera framing of a sequence: the bounding box of all inputs.
Box box_of_all(const RenderArguments& arguments, const std::vector<bool>& assigned,
               const RenderRanks& ranks) {
    Box box;
    for (std::size_t n = 0; n < assigned.size(); ++n)
        if (assigned[n])
            box.include(box_of(arguments.drawing.inputs[n], arguments.drawing.volume,
                               arguments.drawing.points));
    return ranks.box_union ? ranks.box_union(box) : box;
}

/// One picture per input, under one camera and the extinction of the first picture.
/// returns  the report of --json
Json render_sequence(const RenderArguments& arguments, const CLI::App& command,
                     const RenderRanks& ranks) {
    const QuantityArguments& quantity = arguments.quantity;
    if (!arguments.depth_output.empty() && !is_sequence(arguments.depth_output))
        throw CLI::ValidationError("--depth-out takes a folder where -o does");
    if (!quantity.values_output.empty() && !is_sequence(quantity.values_output))
        throw CLI::ValidationError("--values-out takes a folder where -o does");
    const std::vector<std::string>& inputs = arguments.drawing.inputs;
    const std::vector<Frame> frames = frames_of(inputs, arguments.output, ".png");
    const std::vector<Frame> depths = arguments.depth_output.empty()
                                          ? std::vector<Frame>{}
                                          : frames_of(inputs, arguments.depth_output, ".exr");
    const std::vector<Frame> values = quantity.values_output.empty()
                                          ? std::vector<Frame>{}
                                          : frames_of(inputs, quantity.values_output, ".npy");
    const bool fixes_range = quantity.scaled() && quantity.range.empty();
    const std::vector<bool> assigned =
        ranks.assigned ? ranks.assigned(inputs) : std::vector<bool>(frames.size(), true);
    RenderArguments one = arguments;
    one.box = box_of_all(arguments, assigned, ranks);
    if (!ranks.is_root) one.view.save_camera.clear();
    std::vector<PictureReport> own;
    for (std::size_t n = 0; n < frames.size(); ++n) {
        // Extinction, range and unit distance. Only the rank that renders the first picture has them.
        std::array<double, 4> figures;
        figures.fill(-std::numeric_limits<double>::infinity());
        if (assigned[n]) {
            one.drawing.inputs = {frames[n].input};
            one.output = frames[n].output;
            if (!depths.empty()) one.depth_output = depths[n].output;
            if (!values.empty()) one.quantity.values_output = values[n].output;
            const RenderedPicture picture = render(one, command).value();
            const ColorScale scale = picture.scale.value_or(ColorScale{});
            figures = {picture.extinction, scale.low, scale.high,
                       picture.unit_distance.value_or(0)};
            own.push_back(report_of(n, picture));
            if (!arguments.json && !ranks.allgather) print_line(own.back().line);
        }
        if (n > 0) continue;
        ranks.collective.max(figures);
        const auto [extinction, low, high, unit_distance] = figures;
        one.color.extinction = fmt::format("{:.17g}", extinction);
        one.later_frame = true;
        if (quantity.volume()) one.value.unit_distance = unit_distance;
        if (!fixes_range) continue;
        one.quantity.range = fmt::format("{:.17g},{:.17g}", low, high);
        if (ranks.is_root)
            note(
                fmt::format("colours of all pictures from {:.6g} to {:.6g}, the range of the "
                            "first (--range sets another)",
                            low, high));
    }
    std::vector<PictureReport> all = allgather(own, ranks);
    std::ranges::sort(all, {}, &PictureReport::frame);
    Json pictures = Json::array();
    for (const PictureReport& report : all) {
        if (!arguments.json && ranks.allgather && ranks.is_root) print_line(report.line);
        pictures.push_back(report.json);
    }
    return {{"output", arguments.output}, {"pictures", pictures}};
}

/// Files that are written, without the folders of a sequence, whose files have different extensions.
std::vector<std::string> written_files(const RenderArguments& arguments) {
    std::vector<std::string> files{arguments.output, arguments.depth_output,
                                   arguments.quantity.values_output, arguments.view.save_camera};
    std::erase_if(files, is_sequence);
    return files;
}
std::vector<std::string> read_files(const RenderArguments& arguments) {
    std::vector<std::string> files = arguments.drawing.inputs;
    files.insert(files.end(), {arguments.view.camera_file, arguments.color.tf});
    return files;
}

/// Runs the command and prints its report, on the root.
void render_files(const RenderArguments& given, const CLI::App& command, const RenderRanks& ranks) {
    RenderArguments arguments = given;
    arguments.drawing.inputs = expanded(given.drawing.inputs);
    if (ranks.is_root) check_distinct(written_files(arguments), read_files(arguments));
    const CommandMemory memory(arguments.memory);
    if (is_sequence(arguments.output)) {
        const Json report = render_sequence(arguments, command, ranks);
        if (arguments.json && ranks.is_root) print_json(report);
        return;
    }
    const std::optional<RenderedPicture> picture = render(arguments, command, ranks);
    if (!picture) return;
    if (arguments.json)
        print_json(to_json(*picture));
    else
        print(*picture, arguments.repeat > 0);
}

}  // namespace

void add_render(CLI::App& app) { add_render(app, std::make_shared<RenderArguments>(), {}); }

void add_render(CLI::App& app, const std::shared_ptr<RenderArguments>& arguments,
                const RenderRanks& ranks) {
    CLI::App* command =
        app.add_subcommand("render", "Render models, volumes or particles to a picture");
    add_render_options(*command, *arguments);
    command->callback([arguments, command, ranks] { render_files(*arguments, *command, ranks); });
}

}  // namespace vog::cli
