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
#include "conversion/field_conversion.h"
#include "conversion/label_parts.h"
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

MomentOptions moment_options(const ConvertArguments& arguments) {
    if (arguments.moments.budget && arguments.inputs.size() > 1 && arguments.volume.sum)
        throw UsageError(
            "--budget is the size of one model: expected one input, or levels of one mesh");
    return vog::moment_options(arguments);
}

std::optional<Box> period_of(const ConvertArguments& arguments, std::span<const Volume> volumes,
                             const Collective* collective) {
    std::optional<Box> period = period_of(arguments.points);
    if (period && period->empty()) period = domain_box(volumes, collective);
    if (period && period->empty())
        throw Error(fmt::format(
            "{}: the coarsest cells do not fill a box, so its active voxels do not state the "
            "domain, expected --periodic EDGE, --periodic X,Y,Z or --periodic x0,y0,z0,x1,y1,z1",
            arguments.inputs.front()));
    return period;
}

namespace {

/// Stage times as text: "octree 98 ms, search 1200 ms".
std::string times_text(const std::vector<std::pair<std::string, double>>& stage_ms) {
    std::string text;
    for (const auto& [name, ms] : stage_ms)
        text += fmt::format("{}{} {:.3g} ms", text.empty() ? "" : ", ", name, ms);
    return text;
}

double share_of_voxels(const Converted& made) {
    return made.source_voxels
               ? static_cast<double>(made.gaussians) / static_cast<double>(made.source_voxels)
               : 0;
}

/// Level-of-detail hierarchy of the model; empty with --no-hierarchy.
/// index_from_world  lattice of the model's cells; none for particles
Hierarchy hierarchy_of(Gaussians& model, const ConvertArguments& arguments,
                       const std::optional<Affine>& index_from_world, Stages& stages) {
    // Readers of compact files build it (docs/compact.md).
    if (arguments.no_hierarchy || extension_of(arguments.output) == ".vogz") return {};
    return stages.run("hierarchy", [&] { return build_hierarchy(model, {index_from_world}); });
}

/// Volumes of the levels without the voxels that finer levels hide.
Composite compose(const Levels& levels) {
    Composite data = composite(levels);
    if (data.parts.empty()) throw Error("--mask: no active voxel lies inside the masks");
    note(fmt::format("{} levels: {} voxels visible ({} of them partly), {} hidden by finer levels",
                     levels.volumes.size(), count_text(data.voxels), count_text(data.partly_hidden),
                     count_text(data.hidden)));
    return data;
}

/// Note where even the finest model has a larger error than --error.
void note_missed(const std::string& input, double measured, double target) {
    note(fmt::format(
        "{}: measured error {:.4g} in the worst view, above --error {}: even the finest cut is "
        "smoother than the voxels; --error {:.2g} needs far fewer Gaussians",
        input, measured, target, 1.25 * measured));
}

/// The same of the error by value.
void note_missed_by_value(const std::string& input, double measured, double target) {
    note(
        fmt::format("{}: error by value {:.4g} in the worst view, above --error {}: the least of "
                    "all cuts that were tried",
                    input, measured, target));
}

/// Note where the default stopped before its error.
/// measured  "measured error 0.034"
void note_stopped(const std::string& input, const std::string& measured, double target) {
    note(fmt::format(
        "{}: {} in the worst view: the default stops at one Gaussian "
        "to {} voxels (at {} of small data) or at an error of {}, whichever is fewer; --error and "
        "--budget go on",
        input, measured, kVoxelsPerGaussian, count_text(kSmallCount), target));
}

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
nlohmann::ordered_json convert_one(ConvertArguments arguments, const GivenOptions& command,
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
        throw Error(
            fmt::format("{}: a model; vog convert reads models, vog-mpi convert volumes "
                        "and particles",
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
    const bool by_moments = arguments.method == "moments";
    MomentOptions moments = by_moments ? moment_options(arguments) : MomentOptions{};
    PaperOptions paper = by_moments ? PaperOptions{} : paper_options(arguments);
    Stages stages(arguments.verbose && ranks.is_root);
    moments.progress = paper.progress = stages.progress();
    if (command.has("--labels") && arguments.labels.empty())
        throw UsageError("--labels: is empty, expected FILE, FILE:GRID or GRID");
    if (!arguments.labels.empty() && ranks.convert_volumes)
        throw UsageError("--labels: volumes are divided by one process, expected vog convert");
    if (ranks.convert_volumes)
        return ranks.convert_volumes(arguments, {by_moments, moments, paper}, stages);

    LoadedVolumes set =
        stages.run("load", [&] { return load_volumes(arguments.inputs, arguments.volume); });
    std::vector<double> shares;
    if (!arguments.labels.empty())
        shares = stages.run("labels", [&] { return divide_by_labels(arguments, set); });
    print_notes(set.notes);
    const std::optional<Box> period = period_of(arguments, set.volumes);
    moments.periodic = period;
    Composite mesh =
        set.is_mesh() ? stages.run("compose", [&] { return compose(set); }) : Composite{};
    std::vector<Volume>& volumes = set.is_mesh() ? mesh.parts : set.volumes;
    std::vector<Gaussians> parts;                    // one a volume; of a mesh one
    std::vector<std::optional<UniformCells>> cells;  // of each part
    double volume_mass = 0;
    Box box;
    for (const Volume& volume : volumes) {
        volume_mass += mass(volume);
        box.include(world_box(volume));
    }
    moments.origin = paper.origin = model_origin(set.is_mesh() ? mesh.box : box);
    const bool fits = by_moments && !arguments.no_fields && !arguments.volume.ones;
    if (!arguments.joint_field.empty() || (fits && arguments.moments.spread == 1))
        arguments.joint_field = resolved_joint_field(arguments.joint_field, volumes);
    // Alone, the volumes' own values are summed with the cells.
    const bool own_alone = by_moments && !arguments.no_fields && arguments.fields.empty() &&
                           arguments.joint_field.empty() && !arguments.volume.ones;
    if (own_alone) moments.own_field = own_name(volumes);
    const FieldTexts texts = field_texts(arguments, own_name(volumes));
    const std::string joint_field = joint_field_of(arguments, texts, volumes);
    // Adaptive cuts follow the fields, which must be read before.
    const bool carries = !joint_field.empty() || (by_moments && !arguments.no_fields &&
                                                  !own_alone && !moments.block_voxels);
    MomentTotals totals;
    std::vector<std::string> view_notes;
    const auto add = [&](Gaussians part, const MomentReport& one, double part_mass) {
        totals.add(one, part_mass);
        if (!one.view_note.empty())
            view_notes.push_back(fmt::format("{}: {}", part.source, one.view_note));
        if (one.stopped_by_count && one.measured_error >= 0)
            note_stopped(part.source, fmt::format("measured error {:.4g}", one.measured_error),
                         kDefaultError);
        if (joint_field.empty() && moments.error > 0 && one.measured_error > moments.error &&
            !one.as_near_as_interpolation() && !moments.block_voxels && !moments.budget)
            note_missed(part.source, one.measured_error, moments.error);
        parts.push_back(std::move(part));
        cells.push_back(one.cells);
    };
    JointReport joint;
    std::vector<std::string> field_notes;
    const auto convert_for = [&](std::span<Volume> levels) {
        MomentReport one;
        JointReport of_one;
        const double part_mass = set.is_mesh() ? volume_mass : mass(levels.front());
        add(convert_for_field_of(texts, levels, set.is_mesh() ? &mesh : nullptr, moments,
                                 {{}, joint_field, arguments.joint_steps, &of_one, period}, one,
                                 field_notes),
            one, part_mass);
        if (moments.error > 0 && of_one.value_error > moments.error)
            note_missed_by_value(parts.back().source, of_one.value_error, moments.error);
        else if (one.stopped_by_count && of_one.value_error >= 0)
            note_stopped(parts.back().source,
                         fmt::format("error by value {:.4g}", of_one.value_error),
                         kDefaultValueError);
        add_joint(joint, of_one);
    };
    stages.run("convert", [&] {
        MomentReport one;
        if (carries && set.is_mesh()) return convert_for(volumes);
        if (by_moments && set.is_mesh())
            return add(convert_moments(mesh, moments, &one), one, volume_mass);
        if (set.is_mesh()) return add(convert_paper(mesh, paper), one, volume_mass);
        const std::size_t budget = moments.budget;
        for (std::size_t n = 0; n < volumes.size(); ++n) {
            Volume& volume = volumes[n];
            if (budget && !shares.empty())
                moments.budget = static_cast<std::size_t>(std::ceil(double(budget) * shares[n]));
            if (carries)
                convert_for({&volume, 1});
            else
                add(by_moments ? convert_moments(volume, moments, &one)
                               : convert_paper(volume, paper),
                    one, mass(volume));
        }
    });
    if (!arguments.no_fields && !own_alone && !carries)
        stages.run("fields", [&] {
            for (std::size_t n = 0; n < parts.size(); ++n)
                add_fields_of(texts, {.cells = cells[n], .periodic = period},
                              set.is_mesh() ? std::span(volumes) : std::span(volumes).subspan(n, 1),
                              parts[n], field_notes);
        });
    print_notes(field_notes);
    set.notes.insert(set.notes.end(), field_notes.begin(), field_notes.end());
    Gaussians model = std::move(parts.front());
    for (std::size_t n = 1; n < parts.size(); ++n) append(model, parts[n]);
    if (model.size() == 0)
        throw Error(
            fmt::format("{}: no Gaussian: no group of voxels has a mean density above --set "
                        "opacity-threshold={}",
                        arguments.inputs.front(), paper.opacity_threshold));
    if (period) add_periodic_images(model, *period);
    if (by_moments)
        model.summary = summary_text(model, totals.report(volume_mass), "active voxels");
    if (arguments.volume.ones) model.options = "--measure volume " + model.options;
    if (!arguments.joint_field.empty()) {
        model.options += " --for " + arguments.joint_field;
        if (arguments.joint_steps != kJointSteps)
            model.options += fmt::format(" --set joint-steps={}", arguments.joint_steps);
        model.summary += ", " + joint_text(arguments.joint_field, joint);
    }
    const Hierarchy hierarchy =
        hierarchy_of(model, arguments, inverse(volumes.front().world_from_index), stages);
    stages.run("save", [&] { write_model(arguments.output, model, hierarchy); });
    Converted made = converted(model, hierarchy, arguments.output);
    made.joint = joint;
    print_notes(view_notes);
    made.notes = set.notes;
    made.notes.insert(made.notes.end(), view_notes.begin(), view_notes.end());
    return report(arguments, kind, made, volume_mass, totals, stages);
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
            "not "
            "support; expected one file and one output at a time");
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

bool is_model_output(const std::string& output) {
    return extension_of(output) == ".ply" || extension_of(output) == ".vogz";
}

Converted converted(const Gaussians& model, const Hierarchy& hierarchy, const std::string& output) {
    return {model.method,
            model.options,
            model.summary,
            model.size(),
            model.source_voxels,
            hierarchy.size(),
            std::filesystem::file_size(output),
            mass_without_images(model),
            model.fields.names(),
            {}};
}

nlohmann::ordered_json report(const ConvertArguments& arguments, FileKind kind,
                              const Converted& made, double volume_mass,
                              const MomentTotals& moments, const Stages& stages) {
    const double mass_ratio = volume_mass > 0 ? made.mass / volume_mass : 1;
    const bool by_moments = arguments.method == "moments";
    const MomentReport figures = moments.report(volume_mass);
    const double share = share_of_voxels(made);
    if (!arguments.json) {
        print_line(fmt::format("{}: {} Gaussians, {:.3g} % of {} {}, {}, mass ratio {:.5f}",
                               arguments.output, count_text(made.gaussians), 100 * share,
                               count_text(made.source_voxels),
                               kind == FileKind::points ? "particles" : "active voxels",
                               bytes_text(made.bytes), mass_ratio) +
                   (made.fields.empty()
                        ? std::string()
                        : fmt::format(", fields {}", fmt::join(made.fields, ", "))));
        // The file's summary repeats the counts; here what the first line lacks.
        const std::string details = by_moments ? detail_text(figures) : "";
        if (!details.empty()) print_line(details);
        if (!arguments.joint_field.empty())
            print_line(joint_text(arguments.joint_field, made.joint));
        if (by_moments) print_line(times_text(figures.stage_ms));
        return {};
    }
    nlohmann::ordered_json json = {
        {"output", arguments.output},
        {"method", made.method},
        {"options", made.options},
        {"gaussians", made.gaussians},
        {kind == FileKind::points ? "particles" : "active_voxels", made.source_voxels},
        {"share", share},
        {"nodes", made.nodes},
        {"bytes", made.bytes},
        {"mass_ratio", mass_ratio}};
    if (!made.fields.empty()) json["fields"] = made.fields;
    if (by_moments) {
        json["mass_ratio_before_threshold"] = figures.mass_ratio;
        json["dropped_mass_share"] = figures.dropped_mass_share;
        json["dropped_cells"] = figures.dropped_cells;
        if (figures.measured_error >= 0) {
            json["measured_error"] = figures.measured_error;
            json["mean_error"] = figures.mean_error;
            if (figures.interpolation_error >= 0) {
                json["interpolation_error"] = figures.interpolation_error;
                json["mean_interpolation_error"] = figures.mean_interpolation_error;
                json["as_near_as_interpolation"] = figures.as_near_as_interpolation();
            }
            json["stopped_by_count"] = figures.stopped_by_count;
            for (const auto& [name, error] : figures.field_errors)
                json["field_errors"][name] = error;
        }
        for (const auto& [name, ms] : figures.stage_ms) json["convert_ms"][name] = ms;
    }
    if (!arguments.joint_field.empty()) {
        json["joint"] = {{"field", arguments.joint_field},
                         {"error_before", made.joint.error_before},
                         {"error_after", made.joint.error_after},
                         {"removed", made.joint.removed}};
        if (made.joint.value_error >= 0) json["joint"]["value_error"] = made.joint.value_error;
    }
    for (const auto& [name, ms] : stages.times()) json["ms"][name] = ms;
    json["peak_memory"] = peak_memory();
    if (!made.notes.empty()) json["notes"] = made.notes;
    return json;
}

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
                     ".vdb, .xyz, .csv "
                     "or .tsv. A folder (or a name that ends in /): one model per input, for time "
                     "series")
        ->required();
    add_volume_options(*command, arguments->volume);
    add_value(*command, "--method", arguments->method, "moments paper",
              "moments: each Gaussian has the mass, mean and covariance of its cell; paper: block "
              "by block, as Sharma and Schmalstieg");
    command->add_option(
        "--field", arguments->fields,
        "Field that Gaussians carry beside density, for pictures of it (vog render --show): GRID "
        "of the same file, FILE:GRID, or NAME=FILE:GRID; vector grids become vector fields. Of "
        "particles velocity, a column or NAME=COLUMN. Repeatable. The volume's own values are one "
        "by default");
    command->add_option("--labels", arguments->labels,
                        "Labels that divide the volume, as of a segmentation: a grid of whole "
                        "numbers, FILE, FILE:GRID or GRID. No Gaussian "
                        "straddles two of them, and each has its own as the field 'label'");
    add_value(*command, "--measure", arguments->measure, "density volume",
              "Weight of a voxel. density: its value, which must not be negative; volume: 1 for "
              "each active voxel, of signed values too (Hounsfield units, differences, "
              "velocities), which Gaussians carry as a field");
    command->add_flag("--no-fields", arguments->no_fields,
                      "Carry no fields, not even the volume's own values: 24 bytes less for each "
                      "Gaussian");
    add_conversion_options(*command, *arguments);
    add_point_options(*command, arguments->points);
    add_memory_options(*command, arguments->memory,
                       ". Time series: as many files are converted at once as fit");
    command
        ->add_flag("--again", arguments->again,
                   "Time series: convert all files again, also those whose model is newer than the "
                   "file")
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
