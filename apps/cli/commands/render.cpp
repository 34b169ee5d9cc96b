// render.cpp: vog render: load -> render -> shade -> image, for one picture or one per input.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "commands/commands.h"
#include "files/film.h"
#include "files/outputs.h"
#include "files/sequence.h"
#include "options/option_effects.h"
#include "pictures/render_run.h"
#include "pictures/request_file.h"
#include "pictures/views.h"
#include "terminal/terminal.h"
#include "vog/error.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

/// Whether an output is of many pictures.
bool is_of_many(const std::string& output) {
    return is_sequence(output) || is_numbered(output) || is_film(output);
}

/// Report of one picture of a sequence: a line of text and JSON.
struct PictureReport {
    std::size_t frame = 0;
    std::string line;
    Json json;
};
PictureReport report_of(std::size_t frame, const std::string& name,
                        const RenderedPicture& picture) {
    return {frame,
            fmt::format("{}: {}x{}, {:.1f} ms, {}", name, picture.width, picture.height,
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

/// Makes later pictures share the scales of the first one, which only one rank may have.
/// returns  those scales
SharedScales share_first(const std::optional<RenderedPicture>& first, const RenderRanks& ranks,
                         RenderArguments& later) {
    std::array<double, 5> figures;
    figures.fill(-std::numeric_limits<double>::infinity());
    if (first) {
        const SharedScales& own = first->scales;
        figures = {own.extinction, own.low, own.high, own.unit_distance, own.log};
    }
    ranks.collective.max(figures);
    const auto [extinction, low, high, unit_distance, log] = figures;
    const SharedScales all{extinction, low, high, unit_distance, log};
    later.shared = all;
    return all;
}

/// What the camera of a sequence frames: all inputs.
Subject subject_of_all(const RenderArguments& arguments, const std::vector<bool>& assigned,
                       const RenderRanks& ranks) {
    Subject all;
    for (std::size_t n = 0; n < assigned.size(); ++n)
        if (assigned[n])
            all.include(subject_of(arguments.drawing.inputs[n], arguments.drawing.volume,
                                   arguments.drawing.points));
    return joined(all, ranks.collective);
}

/// Output of each input of a sequence.
std::vector<Frame> sequence_frames(const std::vector<std::string>& inputs,
                                   const std::string& output, const std::string& extension) {
    if (output.empty()) return {};
    if (is_sequence(output)) return frames_of(inputs, output, extension);
    std::vector<Frame> frames;
    const auto outputs = numbered_outputs(output, static_cast<int>(inputs.size()), extension);
    for (std::size_t n = 0; n < inputs.size(); ++n) frames.push_back({inputs[n], outputs[n]});
    return frames;
}

/// One picture per input, under one camera and the extinction of the first picture.
/// returns  the report of --json
Json render_sequence(const RenderArguments& arguments, const GivenOptions& command,
                     const RenderRanks& ranks) {
    if (!arguments.depth_output.empty() && !is_of_many(arguments.depth_output))
        throw UsageError("--depth-out needs a folder because -o is one");
    if (!arguments.values_output.empty() && !is_of_many(arguments.values_output))
        throw UsageError("--values-out needs a folder because -o is one");
    const std::vector<std::string>& inputs = arguments.drawing.inputs;
    const std::vector<Frame> frames = sequence_frames(inputs, arguments.output, ".png");
    const std::vector<Frame> depths = sequence_frames(inputs, arguments.depth_output, ".exr");
    const std::vector<Frame> values = sequence_frames(inputs, arguments.values_output, ".npy");
    const bool fixes_range =
        arguments.request.show != Show::depth && !arguments.request.transfer.range;
    const std::vector<bool> assigned =
        ranks.assigned ? ranks.assigned(inputs) : std::vector<bool>(frames.size(), true);
    RenderArguments one = arguments;
    one.subject = subject_of_all(arguments, assigned, ranks);
    std::vector<PictureReport> own;
    for (std::size_t n = 0; n < frames.size(); ++n) {
        std::optional<RenderedPicture> picture;
        if (assigned[n]) {
            one.drawing.inputs = {frames[n].input};
            one.output = frames[n].output;
            if (!depths.empty()) one.depth_output = depths[n].output;
            if (!values.empty()) one.values_output = values[n].output;
            picture = render(one, command).front();
            const bool film = is_film(arguments.output);
            own.push_back(report_of(n, film ? frames[n].input : picture->output, *picture));
            if (!arguments.json && !ranks.allgather) print_line(own.back().line);
        }
        if (n > 0) continue;
        const SharedScales scales = share_first(picture, ranks, one);
        if (fixes_range && ranks.is_root)
            note(
                fmt::format("colours of all pictures from {:.6g} to {:.6g}, the range of the first "
                            "(--range sets another)",
                            scales.low, scales.high));
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

/// The pictures of a turn during which time runs once: picture n of N shows step floor(n steps / N).
std::vector<RenderedPicture> render_turn_in_time(const RenderArguments& arguments,
                                                 const GivenOptions& command,
                                                 const RenderRanks& ranks) {
    const std::vector<std::string>& inputs = arguments.drawing.inputs;
    const int count = arguments.turntable, steps = static_cast<int>(inputs.size());
    RenderArguments one = arguments;
    one.subject = subject_of_all(arguments, std::vector<bool>(inputs.size(), true), ranks);
    std::vector<RenderedPicture> all;
    for (int step = 0; step < steps; ++step) {
        const auto first_of = [&](int n) {
            return static_cast<int>((static_cast<std::int64_t>(n) * count + steps - 1) / steps);
        };
        one.turn_part = {first_of(step), first_of(step + 1)};
        if (one.turn_part->first == one.turn_part->second) continue;
        one.drawing.inputs = {inputs[static_cast<std::size_t>(step)]};
        std::vector<RenderedPicture> pictures = render(one, command, ranks);
        if (step == 0)
            share_first(pictures.empty() ? std::nullopt : std::optional(pictures.front()), ranks,
                        one);
        std::ranges::move(pictures, std::back_inserter(all));
    }
    return all;
}

/// The pictures of a turn.
/// returns  the report of --json
Json render_turn(const RenderArguments& arguments, const GivenOptions& command,
                 const RenderRanks& ranks) {
    const auto check = [&](const std::string& option, const std::string& output,
                           const std::vector<std::string>& extensions, bool film) {
        if (output.empty()) return;
        if (!is_sequence(output) && !is_numbered(output) && !(film && is_film(output)))
            throw UsageError(fmt::format(
                "--turntable: {} {}: expected a folder (a name ending in /), a numbered name "
                "(t_%04d{}){}",
                option, output, extensions.front(), film ? " or a film (.mp4, .webm)" : ""));
        if (ranks.is_root && !is_sequence(output) && !is_film(output))
            check_output(numbered_outputs(output, 1, "").front(), arguments.drawing.inputs,
                         extensions);
    };
    check("-o", arguments.output, {".png", ".exr"}, true);
    check("--depth-out", arguments.depth_output, {".exr"}, false);
    check("--values-out", arguments.values_output, {".npy", ".exr"}, false);
    const std::vector<RenderedPicture> pictures =
        arguments.steps ? render_turn_in_time(arguments, command, ranks)
                        : render(arguments, command, ranks);
    if (pictures.empty()) return {};
    Json list = Json::array();
    std::vector<double> times;
    for (const RenderedPicture& picture : pictures) {
        list.push_back(to_json(picture));
        times.push_back(picture.median_ms());
    }
    const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
    std::ranges::nth_element(times, middle);
    const RenderedPicture& first = pictures.front();
    if (!arguments.json && !is_film(arguments.output))
        print_line(fmt::format("{}: {} pictures of {}x{}, {}, {:.1f} ms each (median)",
                               arguments.output.empty() ? first.depth_output : arguments.output,
                               pictures.size(), first.width, first.height, first.primitives_text,
                               *middle));
    if (!arguments.json && first.has_extinction())
        print_line(fmt::format("extinction {:.6g}, of the first picture", first.extinction));
    else if (!arguments.json && !first.layered)
        print_line(fmt::format("{}: colours from {:.6g} to {:.6g}, of the first picture",
                               first.quantity, first.scale->low, first.scale->high));
    return {{"output", arguments.output}, {"pictures", list}};
}

/// Draws many pictures, into a film where the output is one.
/// returns  the report of --json
Json render_many(RenderArguments arguments, const GivenOptions& command, const RenderRanks& ranks) {
    const auto draw = [&] {
        return arguments.turntable ? render_turn(arguments, command, ranks)
                                   : render_sequence(arguments, command, ranks);
    };
    if (!is_film(arguments.output)) return draw();
    if (ranks.allgather)
        throw Error(arguments.output +
                    ": vog-mpi makes no films; use vog render, or -o FOLDER/ for the pictures");
    if (!arguments.turntable && arguments.drawing.inputs.size() == 1)
        throw UsageError(
            arguments.output +
            ": a film needs several pictures: --turntable N, or one input per time step");
    check_output(arguments.output, arguments.drawing.inputs, {".mp4", ".webm"});
    Film film(arguments.output, arguments.per_second);
    arguments.take_picture = [&](const Image& picture) { film.add(picture); };
    Json report = draw();
    film.finish();
    const double seconds = film.pictures() / arguments.per_second;
    const auto bytes = std::filesystem::file_size(arguments.output);
    report["film"] = {{"pictures", film.pictures()},
                      {"per_second", arguments.per_second},
                      {"seconds", seconds},
                      {"bytes", bytes}};
    if (!arguments.json)
        print_line(fmt::format("{}: {} pictures, {:.4g} s at {:g} a second, {}", arguments.output,
                               film.pictures(), seconds, arguments.per_second, bytes_text(bytes)));
    return report;
}

/// Name of the picture where the command line states none: smoke.png of data/smoke.vdb in the working folder, or
/// smoke-2.png, ... where that exists already.
std::string free_name(const std::string& input) {
    namespace fs = std::filesystem;
    const fs::path path(input);
    const std::string stem = (path.has_filename() ? path : path.parent_path()).stem().string();
    std::error_code code;
    for (int n = 1;; ++n) {
        const std::string name = n == 1 ? stem + ".png" : fmt::format("{}-{}.png", stem, n);
        if (!fs::exists(fs::symlink_status(name, code))) return name;
    }
}

/// Whether the command line states nothing that the command would make.
bool makes_nothing(const RenderArguments& arguments) {
    return arguments.output.empty() && arguments.depth_output.empty() &&
           arguments.values_output.empty() && !arguments.repeat;
}

/// Files that are written, without the folders of a sequence, whose files have different extensions.
std::vector<std::string> written_files(const RenderArguments& arguments) {
    std::vector<std::string> files{arguments.output, arguments.depth_output,
                                   arguments.values_output};
    std::erase_if(files, is_sequence);
    return files;
}
std::vector<std::string> read_files(const RenderArguments& arguments) {
    std::vector<std::string> files = arguments.drawing.inputs;
    const std::vector<std::string>& layers = arguments.drawing.layer_inputs;
    files.insert(files.end(), layers.begin(), layers.end());
    files.insert(files.end(),
                 {arguments.view.camera_file, arguments.words.word("tf"), arguments.request_file});
    return files;
}

/// Takes all models of a single site where many pictures are made, else the first, which a note says.
void name_models_of_site(RenderArguments& arguments, const RenderRanks& ranks) {
    std::vector<std::string>& inputs = arguments.drawing.inputs;
    const std::vector<std::string> models = models_of_one_site(inputs);
    if (models.empty()) return;
    if (is_of_many(arguments.output) && (!arguments.turntable || arguments.steps))
        inputs = models;
    else if (ranks.is_root)
        note_first_model(inputs.front(), models);
}

/// Refuses options without effect on any of the inputs.
/// throws  UsageError as require_effects does
void require_effects_of(const RenderArguments& arguments, const GivenOptions& command) {
    const DrawingArguments& drawing = arguments.drawing;
    const std::string show = word_of(arguments.request.show);
    Facts facts = {{"show", show},
                   {"inputs", drawing.inputs.size() > 1 ? "several" : "one"},
                   {"output", arguments.output.empty()    ? "-"
                              : is_film(arguments.output) ? "film"
                                                          : "picture"}};
    std::set<std::string>
        checked;  // extensions: of a thousand files of one kind one is looked into
    for (const std::string& input : drawing.inputs) {
        if (!checked.insert(extension_of(input)).second) continue;
        const FileKind kind = kind_of(input, drawing.volume.grid);
        facts["input"] = input_fact(kind, {input});
        const auto& renderer = arguments.request.renderer;
        facts["renderer"] = renderer                   ? info_of(*renderer).name
                            : kind == FileKind::volume ? "reference"
                                                       : "splat";
        require_effects(command, facts);
    }
}

/// Runs the command and prints its report, on the root.
void render_files(RenderArguments& given, GivenOptions command, const RenderRanks& ranks) {
    const auto require_one = [&](bool layers) {
        if (layers && !given.turntable && is_of_many(given.output))
            throw UsageError("--layer works with one picture (-o FILE.png) or --turntable");
    };
    require_one(given.words.has("layers"));
    take_request(given, command);
    RenderArguments arguments = given;
    arguments.reading.merge(reading_options(command));
    arguments.drawing.inputs = expanded(given.drawing.inputs);
    name_models_of_site(arguments, ranks);
    require_one(!arguments.request.layers.empty());
    if (makes_nothing(arguments)) {
        if (arguments.turntable)
            throw UsageError(
                "--turntable needs -o with a folder (turn/), a numbered name (t_%04d.png) or a "
                "film (turn.mp4)");
        arguments.output = free_name(arguments.drawing.inputs.front());
    }
    if (ranks.is_root) check_distinct(written_files(arguments), read_files(arguments));
    const CommandMemory memory(arguments.memory);
    require_effects_of(arguments, command);
    // Values of another grid would be other numbers.
    arguments.drawing.volume.refuse_several =
        !arguments.depth_output.empty() || !arguments.values_output.empty();
    if (arguments.turntable || is_of_many(arguments.output)) {
        const Json report = render_many(arguments, command, ranks);
        if (arguments.json && ranks.is_root) print_json(report);
        return;
    }
    for (const RenderedPicture& picture : render(arguments, command, ranks)) {
        if (arguments.json)
            print_json(to_json(picture));
        else
            print(picture, arguments.repeat > 0);
    }
}

}  // namespace

void add_render(CLI::App& app) { add_render(app, std::make_shared<RenderArguments>(), {}); }

void add_render(CLI::App& app, const std::shared_ptr<RenderArguments>& arguments,
                const RenderRanks& ranks) {
    CLI::App* command =
        app.add_subcommand("render", "Render models, volumes or particles to a picture");
    add_render_options(*command, *arguments);
    on_run(*command,
           [arguments, ranks](GivenOptions& given) { render_files(*arguments, given, ranks); });
}

}  // namespace vog::cli
