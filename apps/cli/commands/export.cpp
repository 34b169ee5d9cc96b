// export.cpp: vog export: models, or volumes and particles converted as they come, to one page for
// a browser, to one page an input, or to one PLY.
#include <fmt/core.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.h"
#include "options/camera_options.h"
#include "options/color_options.h"
#include "shared/inputs.h"
#include "shared/sequence.h"
#include "shared/terminal.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/export_html.h"
#include "vog/lod.h"
#include "vog/ply.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kPageGroup = "Page (.html)";

struct ExportArguments {
    std::vector<std::string> inputs, names;
    std::string output, title, description;
    ColorArguments color;
    VolumeInputOptions volume;
    PointInputOptions points;
    ViewArguments view;
    std::size_t budget = 0, levels = 8;
    int threads = 0;
    bool json = false, verbose = false;
    std::optional<Box> box;  ///< views look at this, not at the model: one camera for many
};

std::string stem_of(const std::string& file) { return std::filesystem::path(file).stem().string(); }

/// Volumes, or one mesh of them, by moments: levels of detail are conversions of their own, some
/// 4 dB better than what could be made of the finest (docs/web.md).
std::vector<Gaussians> convert_volumes(const ExportArguments& arguments, std::size_t most,
                                       const Progress& progress) {
    const VolumeSet set = load_volumes(arguments.inputs, arguments.volume);
    if (!set.is_mesh() && set.volumes.size() > 1 && arguments.budget)
        throw CLI::ValidationError(
            "--budget takes one input or levels: it is the size of one model");
    const Composite mesh = set.is_mesh() ? composite(set) : Composite{};
    if (set.is_mesh() && mesh.parts.empty()) throw Error("every voxel lies outside the masks");
    const auto convert = [&](std::size_t budget) {
        MomentOptions options;
        options.budget = budget;
        options.progress = progress;
        if (!set.is_mesh()) return convert_moments(set.volumes.front(), options);
        Gaussians model = convert_moments(mesh, options);
        model.box = mesh.box;
        return model;
    };
    if (!set.is_mesh() && set.volumes.size() > 1) {
        Gaussians sum;
        for (const Volume& volume : set.volumes) append(sum, convert_moments(volume));
        return detail_levels(std::move(sum), most);
    }
    std::vector<Gaussians> models{convert(arguments.budget)};
    for (const std::size_t budget : detail_budgets(models.front().size(), most))
        models.push_back(convert(budget));
    return models;
}

Gaussians convert_particles(const ExportArguments& arguments, const Progress& progress) {
    PointOptions options = point_options(arguments.points);
    options.budget = arguments.budget;
    options.progress = progress;
    return convert_points(load_points(arguments.inputs, arguments.points, arguments.volume.grid),
                          options);
}

/// Models as they are, one entry each; volumes and particles converted by default, as one.
/// most  levels of detail
std::vector<HtmlModel> load_entries(const ExportArguments& arguments, FileKind kind,
                                    std::size_t most, Stages& stages) {
    std::vector<HtmlModel> entries;
    if (kind == FileKind::model) {
        for (const std::string& input : arguments.inputs) {
            Gaussians model = stages.run("load", [&] { return read_ply(input); });
            stages.run("levels", [&] {
                if (arguments.budget) model = coarsen(model, arguments.budget);
                entries.push_back({stem_of(input), detail_levels(std::move(model), most)});
            });
        }
        return entries;
    }
    entries.push_back({stem_of(arguments.inputs.front()), {}});
    HtmlModel& entry = entries.front();
    stages.run("convert", [&] {
        entry.levels = kind == FileKind::volume
                           ? convert_volumes(arguments, most, stages.progress())
                           : detail_levels(convert_particles(arguments, stages.progress()), most);
    });
    note(fmt::format("{}: converted as vog convert does by default: {} Gaussians",
                     arguments.inputs.front(), count_text(entry.levels.front().size())));
    return entries;
}

Json write_joined(const ExportArguments& arguments, const std::vector<HtmlModel>& entries,
                  Stages& stages) {
    Gaussians model;
    for (const HtmlModel& entry : entries) append(model, entry.levels.front());
    stages.run("save", [&] { write_ply(arguments.output, model); });
    if (!arguments.json)
        fmt::print("{}: {} Gaussians, {}\n", arguments.output, count_text(model.size()),
                   bytes_text(ply_bytes(model)));
    return {{"output", arguments.output}, {"gaussians", model.size()}, {"bytes", ply_bytes(model)}};
}

Json report_page(const ExportArguments& arguments, const std::vector<HtmlModel>& entries,
                 const HtmlReport& report, const Stages& stages) {
    if (!arguments.json) {
        for (const HtmlModel& entry : entries) {
            std::string counts;
            for (const Gaussians& level : entry.levels)
                counts += (counts.empty() ? "" : ", ") + count_text(level.size());
            fmt::print("{}: {} Gaussians\n", entry.name, counts);
        }
        fmt::print("{}: {}, of which the viewer {}\n", arguments.output, bytes_text(report.bytes),
                   bytes_text(report.viewer_bytes));
    }
    Json json = {{"output", arguments.output},
                 {"bytes", report.bytes},
                 {"viewer_bytes", report.viewer_bytes},
                 {"gaussians", report.gaussians},
                 {"extinction", report.extinction}};
    for (const HtmlModel& entry : entries) {
        Json counts = Json::array();
        for (const Gaussians& level : entry.levels) counts.push_back(level.size());
        json["models"].push_back({{"name", entry.name}, {"levels", counts}});
    }
    for (const auto& [name, ms] : stages.times()) json["ms"][name] = ms;
    return json;
}

HtmlOptions page_options(const ExportArguments& arguments, const CLI::App& command,
                         const HtmlModel& first) {
    HtmlOptions options;
    options.title = command.count("--title") ? arguments.title : first.name;
    options.description = arguments.description;
    options.tf = load_transfer_function(arguments.color.tf);
    options.extinction = asked_extinction(arguments.color);
    ColorArguments color = arguments.color;
    options.system_background = color.background == "system";
    if (options.system_background) color.background = ColorArguments{}.background;
    options.shading = shading_of(color);
    // Without a word about the view each model has its own, but for pages of one sequence.
    bool viewed = arguments.box.has_value();
    for (const char* option : {"--azimuth", "--elevation", "--distance", "--fov", "--eye",
                               "--look-at", "--up", "--camera", "--save-camera"})
        viewed |= command.count(option) > 0;
    if (viewed)
        options.camera = camera_from(arguments.view, command,
                                     arguments.box ? *arguments.box : view_box(first.levels[0]));
    if (viewed && !arguments.view.save_camera.empty())
        write_camera(arguments.view.save_camera, *options.camera);
    return options;
}

Json write_page(const ExportArguments& arguments, const CLI::App& command,
                std::vector<HtmlModel> entries, Stages& stages) {
    if (!arguments.names.empty() && arguments.names.size() != entries.size())
        throw CLI::ValidationError(fmt::format("{} names for {} models, expected one each",
                                               arguments.names.size(), entries.size()));
    for (std::size_t n = 0; n < arguments.names.size(); ++n) entries[n].name = arguments.names[n];
    const HtmlOptions options = page_options(arguments, command, entries.front());
    const HtmlReport report =
        stages.run("save", [&] { return write_html(arguments.output, entries, options); });
    return report_page(arguments, entries, report, stages);
}

/// One page, or one PLY.
Json export_one(const ExportArguments& arguments, const CLI::App& command) {
    check_output(arguments.output, arguments.inputs, {".html", ".ply"});
    const FileKind kind = common_kind(arguments.inputs, arguments.volume.grid);
    if (kind != FileKind::points) refuse_group(command, kPointGroup, "models and volumes");
    const bool page = !arguments.output.ends_with(".ply");
    if (!page) {
        refuse_group(command, kPageGroup, "-o " + arguments.output);
        refuse_group(command, "View", "-o " + arguments.output);
    }
    Stages stages(arguments.verbose);
    std::vector<HtmlModel> entries =
        load_entries(arguments, kind, page ? arguments.levels : 1, stages);
    return page ? write_page(arguments, command, std::move(entries), stages)
                : write_joined(arguments, entries, stages);
}

/// A page of each input: one camera, of all boxes, and the extinction of the first page.
Json export_sequence(const ExportArguments& all, const CLI::App& command) {
    if (!all.names.empty())
        throw CLI::ValidationError("--name is for the switch of one page, not for a folder");
    ExportArguments one = all;
    one.box = Box{};
    for (const std::string& input : all.inputs)
        one.box->include(box_of(input, all.volume, all.points));
    Json pages = Json::array();
    for (const Frame& frame : frames_of(all.inputs, all.output, ".html")) {
        one.inputs = {frame.input};
        one.output = frame.output;
        pages.push_back(export_one(one, command));
        one.color.extinction = fmt::format("{:.17g}", pages.front().at("extinction").get<double>());
    }
    return {{"output", all.output}, {"pages", pages}};
}

void export_files(const ExportArguments& given, const CLI::App& command) {
    ExportArguments arguments = given;
    arguments.inputs = expanded(given.inputs);
    const ThreadLimit limit(arguments.threads);
    const Json json = is_sequence(arguments.output) ? export_sequence(arguments, command)
                                                    : export_one(arguments, command);
    if (arguments.json) fmt::print("{}\n", json.dump(2));
}

void add_page_options(CLI::App& command, ExportArguments& arguments) {
    const auto add = [&](const std::string& name, auto& value, const std::string& text) {
        return command.add_option(name, value, text)->group(kPageGroup);
    };
    add("--title", arguments.title, "Title; default: the first model's name");
    add("--description", arguments.description, "A sentence or more below the title");
    add("--name", arguments.names,
        "What the switch calls a model, once for each; default: its file's name")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    add("--levels", arguments.levels,
        "Levels of detail to offer at most: the model, then a quarter as many Gaussians each time; "
        "1: the model alone")
        ->check(CLI::Range(1, 32))
        ->capture_default_str();
    add_color_options(command, arguments.color, kPageGroup,
                      ", or system: black or white, as the reader's is");
}

}  // namespace

void add_export(CLI::App& app) {
    auto arguments = std::make_shared<ExportArguments>();
    CLI::App* command = app.add_subcommand(
        "export", "Write models as one page for a browser, self-contained, or as one PLY");
    command
        ->add_option("inputs", arguments->inputs,
                     "PLY models, which the page offers in a switch; or volumes or particles, "
                     "which are converted as vog convert does by default; quoted patterns match "
                     "in natural order: 'frame_*.ply'")
        ->required();
    command
        ->add_option("-o,--output", arguments->output,
                     "Page to write (.html), or model (.ply). A folder (or a name that ends in /): "
                     "a page of each input, under one camera and one extinction")
        ->required();
    command
        ->add_option("--budget", arguments->budget,
                     "At most this many Gaussians a model; more are joined with their neighbours")
        ->check(CLI::PositiveNumber);
    add_page_options(*command, *arguments);
    add_volume_options(*command, arguments->volume);
    add_point_options(*command, arguments->points);
    add_view_options(*command, arguments->view);
    command->add_option("--threads", arguments->threads, "Threads to use; 0: all cores")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command->add_flag("--json", arguments->json, "Print one JSON object and nothing else");
    command->add_flag("--verbose,-v", arguments->verbose, "Print the time of each stage");
    command->callback([arguments, command] { export_files(*arguments, *command); });
}

}  // namespace vog::cli
