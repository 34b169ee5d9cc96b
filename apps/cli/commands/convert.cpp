// convert.cpp: vog convert: load -> convert -> save, to one model or one per input.
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands/commands.h"
#include "conversion/convert_run.h"
#include "conversion/volume_conversion.h"
#include "files/outputs.h"
#include "files/sequence.h"
#include "models/model_inputs.h"
#include "options/conversion_options.h"
#include "options/field_options.h"
#include "options/option_effects.h"
#include "options/parser/settings.h"
#include "options/parser/validators.h"
#include "vog/convert_moments.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/memory.h"
#include "vog/model_io.h"
#include "vog/periodic.h"
#include "vog/volume_io.h"

namespace vog::cli {

namespace {

nlohmann::ordered_json convert_particles(const ConvertArguments& arguments,
                                         const ConvertRanks& ranks) {
    ConversionOptions given = arguments;
    given.particles = point_options(arguments.points);
    PointOptions options = point_options(given);
    options.collective = ranks.collective;
    options.fields = parse_point_fields(arguments.fields);
    const bool paper = arguments.method == "paper";
    if (paper && arguments.points.value.empty()) options.value = "speed";
    Stages stages(arguments.verbose && ranks.is_root);
    options.progress = stages.progress();

    std::vector<std::string> notes;
    const Points points = stages.run("load", [&] {
        return load_points(arguments.inputs, arguments.points, arguments.volume, notes);
    });
    if (!is_model_output(arguments.output)) {
        if (!ranks.is_root) return {};
        stages.run("save", [&] { write_points(arguments.output, points); });
        print_notes(notes);
        if (!arguments.json)
            print_line(
                fmt::format("{}: {} particles", arguments.output, count_text(points.size())));
        nlohmann::ordered_json json = {{"output", arguments.output}, {"particles", points.size()}};
        if (!notes.empty()) json["notes"] = notes;
        return json;
    }
    MomentReport one;
    Gaussians model = stages.run("convert", [&] {
        return paper ? convert_points_paper(points, options.value, options.radius,
                                            arguments.paper.kappa, options.fields)
                     : convert_points(points, options, &one);
    });
    if (!ranks.is_root) return {};
    if (!one.view_note.empty())
        notes.push_back(fmt::format("{}: {}", arguments.inputs.front(), one.view_note));
    print_notes(notes);
    double sum = 0;
    for (const float value : point_values(points, options.value)) sum += value;
    MomentTotals totals;
    totals.add(one, sum);
    if (options.error > 0 && one.measured_error > options.error)
        note_missed(arguments.inputs.front(), one.measured_error, options.error);
    if (!paper) model.summary = summary_text(model, totals.report(sum), "particles");
    const Hierarchy hierarchy = hierarchy_of(model, arguments, {}, stages);
    stages.run("save", [&] { write_model(arguments.output, model, hierarchy); });
    Converted made = converted(model, hierarchy, arguments.output);
    made.notes = notes;
    return report(arguments, FileKind::points, made, sum, totals, stages);
}

/// Writes models as one: of other files, without fields, or coarsened.
nlohmann::ordered_json convert_models(const ConvertArguments& arguments) {
    Stages stages(arguments.verbose);
    ModelArguments from = arguments;
    from.budget = arguments.moments.budget;
    ModelInputs inputs(from, stages);
    const bool keeps = !arguments.no_hierarchy && extension_of(arguments.output) == ".ply";
    InputModel input = inputs.count() == 1 ? inputs.read(0, keeps) : InputModel{{}, inputs.sum()};
    const Gaussians& model = input.model;
    const Hierarchy hierarchy = input.hierarchy.empty()
                                    ? hierarchy_of(input.model, arguments, {}, stages)
                                    : std::move(input.hierarchy);
    stages.run("save", [&] { write_model(arguments.output, model, hierarchy); });
    const std::uint64_t bytes = std::filesystem::file_size(arguments.output);
    if (!arguments.json)
        print_line(fmt::format("{}: {} Gaussians, {}", arguments.output, count_text(model.size()),
                               bytes_text(bytes)));
    nlohmann::ordered_json json = {
        {"output", arguments.output}, {"gaussians", model.size()}, {"bytes", bytes}};
    for (const auto& [name, ms] : stages.times()) json["ms"][name] = ms;
    return json;
}

/// Converts all inputs to one model.
/// in_sequence  whether it is one of a folder's
/// returns      the report of --json; null where it was printed in words
nlohmann::ordered_json convert_one(const ConvertArguments& arguments, const GivenOptions& command,
                                   const ConvertRanks& ranks, bool in_sequence = false) {
    const FileKind kind = common_kind(arguments.inputs, arguments.volume.grid);
    if (ranks.collective && extension_of(arguments.output) == ".vogz")
        throw Error(
            fmt::format("{}: vog-mpi convert writes .ply, which vog pack packs", arguments.output));
    if (kind == FileKind::points)
        check_output(arguments.output, arguments.inputs,
                     {".ply", ".vogz", ".vdb", ".xyz", ".csv", ".tsv"});
    else
        check_output(arguments.output, arguments.inputs, {".ply", ".vogz"});
    if (kind == FileKind::model && ranks.collective)
        throw Error(fmt::format(
            "{}: a model; vog convert reads models, vog-mpi convert volumes and particles",
            arguments.inputs.front()));
    const std::string of_particles = arguments.method == "paper" ? "paper-particles" : "particles";
    Facts facts = {{"input", input_fact(kind, arguments.inputs)},
                   {"conversion", kind == FileKind::points ? of_particles : arguments.method},
                   {"output", in_sequence ? "models/" : extension_of(arguments.output)}};
    // Particles that are written as they are: masses count where negative ones become 0.
    if (!command.has("--clip-negative")) facts["values"] = facts["output"];
    require_effects(command, facts);
    if (kind == FileKind::points) return convert_particles(arguments, ranks);
    if (kind == FileKind::model) return convert_models(arguments);
    VolumeConversion how{arguments.method == "moments", {}, {}};
    if (how.by_moments)
        how.moments = moment_options(arguments);
    else
        how.paper = paper_options(arguments);
    Stages stages(arguments.verbose && ranks.is_root);
    how.moments.progress = how.paper.progress = stages.progress();
    if (command.has("--labels") && arguments.labels.empty())
        throw UsageError("--labels: is empty, expected FILE, FILE:GRID or GRID");
    if (!arguments.labels.empty() && ranks.convert_volumes)
        throw UsageError("--labels: volumes are divided by one process, expected vog convert");
    return ranks.convert_volumes ? ranks.convert_volumes(arguments, how, stages)
                                 : convert_volumes(arguments, how, stages);
}

/// Estimated memory of converting a file, bytes: its leaves twice, and once more for its octree.
std::uint64_t memory_needed(const ConvertArguments& arguments, const std::string& input) {
    constexpr std::uint64_t kBytesPerFileByte = 8, kLeaves = 3;
    if (kind_of(input, arguments.volume.grid) != FileKind::volume || input.ends_with(".nvdb")) {
        std::error_code missing;  // reported by its reader
        const std::uint64_t bytes = std::filesystem::file_size(input, missing);
        return missing ? 0 : kBytesPerFileByte * bytes;
    }
    VdbOptions options;
    options.grid = arguments.volume.grid;
    options.level_set_to_fog = arguments.volume.level_set_to_fog;
    options.values = arguments.volume.values;
    options.ones = arguments.volume.ones;
    const std::uint64_t leaves = kLeaves + arguments.fields.size();
    return leaves * sizeof(Leaf) * VolumeReader(input, options).leaf_count();
}

/// Drops the frames that are assigned to other ranks.
void keep_assigned(std::vector<Frame>& frames, const ConvertRanks& ranks) {
    if (!ranks.assigned) return;
    std::vector<std::string> inputs;
    for (const Frame& frame : frames) inputs.push_back(frame.input);
    const std::vector<bool> assigned = ranks.assigned(inputs);
    std::size_t n = 0;
    std::erase_if(frames, [&](const Frame&) { return !assigned[n++]; });
}

/// The ranks' reports of a sequence as one. They travel as JSON text, because MPI exchanges bytes
/// between processes and the reports hold lists of any length.
nlohmann::ordered_json joined(nlohmann::ordered_json own, const ConvertRanks& ranks) {
    if (!ranks.allgather) return own;
    nlohmann::ordered_json all;
    for (const std::string& text : ranks.allgather(json_line(own))) {
        const auto one = nlohmann::ordered_json::parse(text);
        if (all.is_null()) {
            all = one;
            continue;
        }
        all["there_already"] =
            all["there_already"].get<std::size_t>() + one["there_already"].get<std::size_t>();
        for (const auto& model : one["models"]) all["models"].push_back(model);
    }
    return all;
}

/// Converts every input to a model of its own. Models newer than their input are kept, unless
/// --again is given.
nlohmann::ordered_json convert_sequence(const ConvertArguments& arguments,
                                        const GivenOptions& command, std::uint64_t memory,
                                        const ConvertRanks& ranks) {
    if (arguments.volume.grid.find_first_of("*?") != std::string::npos)
        throw UsageError(
            "--grid with a pattern joins grids to the levels of one mesh, which a sequence does "
            "not support; expected one file and one output at a time");
    std::vector<Frame> frames = frames_of(arguments.inputs, arguments.output, ".ply");
    keep_assigned(frames, ranks);
    const std::size_t all = frames.size();
    if (!arguments.again) std::erase_if(frames, is_fresh);
    if (frames.size() < all)
        note(
            fmt::format("{} of {} models exist and are newer than their input: kept (--again "
                        "converts them again)",
                        all - frames.size(), all));
    std::mutex mutex;
    std::map<std::string, nlohmann::ordered_json> reports;
    for_each_frame(
        frames, memory, [&](const Frame& frame) { return memory_needed(arguments, frame.input); },
        [&](const Frame& frame) {
            ConvertArguments one = arguments;
            one.inputs = {frame.input};
            one.output = frame.output;
            nlohmann::ordered_json report = convert_one(one, command, {}, true);
            const std::lock_guard lock(mutex);
            reports[frame.output] = std::move(report);
        });
    nlohmann::ordered_json json = {{"output", arguments.output},
                                   {"there_already", all - frames.size()},
                                   {"models", nlohmann::ordered_json::array()}};
    for (const Frame& frame : frames) json["models"].push_back(reports[frame.output]);
    return joined(std::move(json), ranks);
}

void convert(const ConvertArguments& given, const GivenOptions& command,
             const ConvertRanks& ranks) {
    ConvertArguments arguments = given;
    arguments.inputs = expanded(given.inputs);
    arguments.volume.ones = given.measure == "volume";
    const CommandMemory memory(arguments.memory);
    const ThreadLimit threads(arguments.threads);
    const nlohmann::ordered_json json =
        is_sequence(arguments.output) ? convert_sequence(arguments, command, memory.bytes(), ranks)
                                      : convert_one(arguments, command, ranks);
    if (arguments.json && ranks.is_root) print_json(json);
}

}  // namespace

void add_convert(CLI::App& app) { add_convert(app, std::make_shared<ConvertArguments>(), {}); }

CLI::App* add_convert(CLI::App& app, const std::shared_ptr<ConvertArguments>& arguments,
                      const ConvertRanks& ranks) {
    CLI::App* command = app.add_subcommand("convert",
                                           "Convert volumes or particles to a model of 3D "
                                           "Gaussians; or join, thin out and rewrite models");
    command
        ->add_option(
            "inputs", arguments->inputs,
            "Volumes (.vdb, .nvdb; .nii, .nrrd, .mha, .tif, .fits), particles (.xyz, .csv, .tsv, "
            ".vdb, .hdf5) or models (.ply, .vogz, sites). Several give one model, or one model "
            "each if -o is a folder. Quoted patterns match files in natural order: 'frame_*.vdb'")
        ->required();
    command
        ->add_option("-o,--output", arguments->output,
                     "Model to write (.ply or .vogz); particles can be written unconverted as "
                     ".vdb, .xyz, .csv or .tsv. A folder (or a name that ends in /): one model per "
                     "input, for time series")
        ->required();
    add_volume_options(*command, arguments->volume);
    add_value(*command, "--method", arguments->method, "moments paper",
              "moments: each Gaussian has the mass, mean and covariance of its cell; paper: block "
              "by block, as Sharma and Schmalstieg");
    command->add_option("--field", arguments->fields,
                        "Field that Gaussians carry beside density, for pictures of it (vog render "
                        "--show): GRID of the same file, FILE:GRID, or NAME=FILE:GRID; vector "
                        "grids become vector fields. Of particles velocity, a column or "
                        "NAME=COLUMN. Repeatable. The volume's own values are one by default");
    command->add_option("--labels", arguments->labels,
                        "Labels that divide the volume, as of a segmentation: a grid of whole "
                        "numbers, FILE, FILE:GRID or GRID. No Gaussian straddles two of them, and "
                        "each has its own as the field 'label'");
    add_value(*command, "--measure", arguments->measure, "density volume",
              "Weight of a voxel. density: its value, which must not be negative; volume: 1 for "
              "each active voxel, of signed values too (Hounsfield units, differences, "
              "velocities), which Gaussians carry as a field");
    command->add_flag(
        "--no-fields", arguments->no_fields,
        "Carry no fields, not even the volume's own values: 24 bytes less for each Gaussian");
    add_conversion_options(*command, *arguments);
    add_point_options(*command, arguments->points);
    add_memory_options(*command, arguments->memory,
                       ". Time series: as many files are converted at once as fit");
    command
        ->add_flag(
            "--again", arguments->again,
            "Time series: convert all files again, also those whose model is newer than the file")
        ->group(kLargeDataGroup);
    command->add_flag("--no-hierarchy", arguments->no_hierarchy,
                      "Write no level-of-detail hierarchy (coarser Gaussians for distant views): a "
                      "smaller file, but distant views cost as much as near ones");
    add_run_options(*command, arguments->threads, arguments->json, arguments->verbose);
    on_run(*command,
           [arguments, ranks](GivenOptions& given) { convert(*arguments, given, ranks); });
    return command;
}

}  // namespace vog::cli
