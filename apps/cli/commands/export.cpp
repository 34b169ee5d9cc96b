// export.cpp: vog export: models to an HTML page for a browser, one page per input, or one PLY;
// volumes and particles are converted first.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands/commands.h"
#include "fields/volume_fields.h"
#include "models/compact_run.h"
#include "models/exchange_run.h"
#include "models/page_options.h"
#include "models/site_run.h"
#include "options/memory_options.h"
#include "options/option_effects.h"
#include "options/parser/settings.h"
#include "options/parser/validators.h"
#include "shared/inputs.h"
#include "shared/outputs.h"
#include "shared/sequence.h"
#include "shared/terminal.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/export_html.h"
#include "vog/lod.h"
#include "vog/model_io.h"
#include "vog/ply.h"
#include "vog/site.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

struct ExportArguments {
    std::vector<std::string> inputs;
    std::string output;
    PageArguments page;
    CompactArguments compact;
    SplatArguments splats;
    VolumeInputOptions volume;
    PointInputOptions points;
    std::size_t budget = 0, levels = 8;
    int threads = 0;
    bool json = false, verbose = false, no_fields = false;
    bool site = false;  ///< --site
    std::string from;   ///< --from; empty: the models lie in the page or beside it
    MemoryArguments memory;
};

/// Whether a folder is written as a site: of one input, or with --site.
bool makes_site(const ExportArguments& arguments) {
    return is_sequence(arguments.output) && (arguments.site || arguments.inputs.size() == 1);
}

/// Facts by which options have an effect.
Facts facts_of(const ExportArguments& arguments, FileKind kind) {
    const std::string extension = extension_of(arguments.output);
    const bool other_layout = extension == ".ply" && arguments.splats.layout != "vog";
    Facts facts = {{"input", input_fact(kind, arguments.inputs)},
                   {"output", makes_site(arguments) ? "site"
                              : other_layout        ? arguments.splats.layout
                                                    : extension}};
    if (extension == ".html" || makes_site(arguments))
        facts["show"] = word_of(arguments.page.words.show());
    return facts;
}

/// Volumes, or the levels of one mesh, converted by moments. Each level of detail is a conversion
/// of its own, about 4 dB better than coarsening the finest one (docs/web.md).
/// most     number of levels of detail at most
/// lattice  receives the map to the voxels of the volume or of the coarsest level; null: not wanted
std::vector<Gaussians> convert_volumes(const ExportArguments& arguments, std::size_t most,
                                       const Progress& progress, std::vector<std::string>& notes,
                                       std::optional<Affine>* lattice = nullptr) {
    const LoadedVolumes set = load_volumes(arguments.inputs, arguments.volume);
    notes = set.notes;
    print_notes(notes);
    if (lattice) *lattice = inverse(set.volumes.front().world_from_index);
    if (!set.is_mesh() && set.volumes.size() > 1 && arguments.budget)
        throw UsageError(
            "--budget is the size of one model: expected one input, or levels of one mesh");
    const Composite mesh = set.is_mesh() ? composite(set) : Composite{};
    if (set.is_mesh() && mesh.parts.empty())
        throw Error("--mask: no active voxel lies inside the masks");
    const auto convert = [&](std::size_t budget) {
        MomentOptions options;
        options.budget = budget;
        options.progress = progress;
        if (!arguments.no_fields) options.own_field = own_name(set.volumes);
        Gaussians model = set.is_mesh() ? convert_moments(mesh, options)
                                        : convert_moments(set.volumes.front(), options);
        return model;
    };
    if (!set.is_mesh() && set.volumes.size() > 1) {
        Gaussians sum;
        for (const Volume& volume : set.volumes) {
            MomentOptions options;
            if (!arguments.no_fields) options.own_field = own_name(set.volumes);
            append(sum, convert_moments(volume, options));
        }
        return detail_levels(std::move(sum), most);
    }
    std::vector<Gaussians> models{convert(arguments.budget)};
    for (const std::size_t budget : detail_budgets(models.front().size(), most))
        models.push_back(convert(budget));
    return models;
}

Gaussians convert_particles(const ExportArguments& arguments, const Progress& progress,
                            std::vector<std::string>& notes) {
    PointOptions options = point_options(arguments.points);
    options.budget = arguments.budget;
    options.progress = progress;
    const Points points = load_points(arguments.inputs, arguments.points, arguments.volume, notes);
    Gaussians model = convert_points(points, options);
    print_notes(notes);
    return model;
}

/// Entries of the page: one per model; one for all volumes or particles, converted with default
/// options.
/// most  number of levels of detail at most
std::vector<HtmlModel> load_entries(const ExportArguments& arguments, FileKind kind,
                                    std::size_t most, Stages& stages,
                                    std::vector<std::string>& notes) {
    std::vector<HtmlModel> entries;
    if (kind == FileKind::model) {
        for (const std::string& input : arguments.inputs) {
            Gaussians model = stages.run(
                "load", [&] { return load_model(input, nullptr, arguments.volume.values); });
            if (arguments.no_fields) model.fields = {};
            stages.run("levels", [&] {
                if (arguments.budget) model = coarsen(model, arguments.budget);
                entries.push_back(
                    {model_name({}, input, 0), detail_levels(std::move(model), most)});
            });
        }
        return entries;
    }
    entries.push_back({model_name({}, arguments.inputs.front(), 0), {}});
    HtmlModel& entry = entries.front();
    stages.run("convert", [&] {
        entry.levels =
            kind == FileKind::volume
                ? convert_volumes(arguments, most, stages.progress(), notes)
                : detail_levels(convert_particles(arguments, stages.progress(), notes), most);
    });
    note(fmt::format("{}: converted with the default options of vog convert: {} Gaussians",
                     arguments.inputs.front(), count_text(entry.levels.front().size())));
    return entries;
}

/// Writes all models as one, exactly or compact.
Json write_joined(const ExportArguments& arguments, const GivenOptions& command,
                  const std::vector<HtmlModel>& entries, Stages& stages) {
    Gaussians model;
    for (const HtmlModel& entry : entries) append(model, entry.levels.front());
    if (entries.size() > 1)
        note(fmt::format("{}: the sum of {} models", arguments.output, entries.size()));
    const Vec3d up = up_of(arguments.page.view, vog::subject_of(model.box, model.content));
    if (is_splat_output(arguments.output, arguments.splats))
        return write_exchange(
            arguments.output, std::move(model), arguments.splats,
            {page_request(arguments.page).extinction,
             arguments.page.words.word("tf", default_map(Show::depth)),
             arguments.page.words.word("field"), command.has_any({"--tf", "--field"}), up},
            stages, arguments.json);
    if (extension_of(arguments.output) == ".vogz") {
        CompactArguments compact = arguments.compact;
        compact.values = arguments.volume.values;
        return write_compact(arguments.output, std::move(model), compact, stages, arguments.json);
    }
    stages.run("save", [&] { write_ply(arguments.output, model); });
    if (!arguments.json)
        print_line(fmt::format("{}: {} Gaussians, {}", arguments.output, count_text(model.size()),
                               bytes_text(ply_bytes(model))));
    return {{"output", arguments.output}, {"gaussians", model.size()}, {"bytes", ply_bytes(model)}};
}

Json report_page(const ExportArguments& arguments, const std::vector<HtmlModel>& entries,
                 const HtmlReport& report, const Stages& stages) {
    if (!arguments.json) {
        for (const HtmlModel& entry : entries) {
            std::string counts;
            for (const Gaussians& level : entry.levels)
                counts += (counts.empty() ? "" : ", ") + count_text(level.size());
            print_line(fmt::format("{}: {} Gaussians", entry.name, counts));
        }
        print_line(fmt::format("{}: {}, {} of them the viewer", arguments.output,
                               bytes_text(report.bytes), bytes_text(report.viewer_bytes)));
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

/// Result of one export.
struct Exported {
    Json json;              ///< the report of --json
    double extinction = 1;  ///< of a page's first model
    HtmlQuantity quantity{};
};

Exported write_page(const ExportArguments& arguments, const GivenOptions& command,
                    std::vector<HtmlModel> entries, Stages& stages,
                    std::vector<std::string>& notes) {
    check_names(arguments.page, entries.size());
    for (std::size_t n = 0; n < arguments.page.names.size(); ++n)
        entries[n].name = arguments.page.names[n];
    const HtmlOptions options =
        page_options(arguments.page, command, entries.front(), arguments.inputs.front(), notes);
    const HtmlReport report =
        stages.run("save", [&] { return write_html(arguments.output, entries, options); });
    return {report_page(arguments, entries, report, stages), report.extinction, options.quantity};
}

/// throws  vog::Error for OpenUSD's binary layers
void refuse_binary_usd(const std::string& output) {
    const std::string extension = extension_of(output);
    if (extension != ".usdc" && extension != ".usd") return;
    const std::string text = std::filesystem::path(output).replace_extension(".usda").string();
    throw Error(
        fmt::format("{}: OpenUSD is written as text: vog export -o {}, then usdcat {} -o {}",
                    output, text, text, output));
}

/// Writes one page or one PLY.
Exported export_one(const ExportArguments& arguments, const GivenOptions& command) {
    refuse_binary_usd(arguments.output);
    check_output(arguments.output, arguments.inputs,
                 {".html", ".ply", ".vogz", ".spz", ".glb", ".usda"});
    const FileKind kind = common_kind(arguments.inputs, arguments.volume.grid);
    require_effects(command, facts_of(arguments, kind));
    const bool page = extension_of(arguments.output) == ".html";
    Stages stages(arguments.verbose);
    std::vector<std::string> notes;
    std::vector<HtmlModel> entries =
        load_entries(arguments, kind, page ? arguments.levels : 1, stages, notes);
    Exported made = page ? write_page(arguments, command, std::move(entries), stages, notes)
                         : Exported{write_joined(arguments, command, entries, stages)};
    if (!notes.empty()) made.json["notes"] = notes;
    return made;
}

/// Writes one page per input, under one camera, which frames all boxes, and the extinction of the
/// first page.
/// returns  the report of --json
Json export_sequence(const ExportArguments& all, const GivenOptions& command) {
    if (!all.page.names.empty())
        throw UsageError("--name names the models of one page: not for a folder of pages");
    ExportArguments one = all;
    one.page.subject = Subject{};
    for (const std::string& input : all.inputs)
        one.page.subject->include(subject_of(input, all.volume, all.points));
    Json pages = Json::array();
    for (const Frame& frame : frames_of(all.inputs, all.output, ".html")) {
        one.inputs = {frame.input};
        one.output = frame.output;
        const Exported page = export_one(one, command);
        // After the first page, its automatic extinction and transfer function.
        one.page.chosen = page.quantity;
        one.page.words.given["extinction"] = {fmt::format("{:.17g}", page.extinction)};
        pages.push_back(page.json);
    }
    return {{"output", all.output}, {"pages", pages}};
}

/// Model n of a site.
SiteInput read_site_input(const ExportArguments& arguments, FileKind kind, std::size_t n,
                          Stages& stages, std::vector<std::string>& notes) {
    const std::string& file = arguments.inputs[n];
    SiteInput input{model_name(arguments.page, file, n), {}};
    if (kind == FileKind::model) {
        input.model = stages.run(
            "load", [&] { return load_model(file, &input.hierarchy, arguments.volume.values); });
        if (arguments.no_fields) input.model.fields = input.hierarchy.nodes.fields = {};
        if (arguments.budget && input.model.size() > arguments.budget)
            input.model = coarsen(input.model, arguments.budget), input.hierarchy = {};
        return input;
    }
    stages.run("convert", [&] {
        input.model =
            kind == FileKind::volume
                ? convert_volumes(arguments, 1, stages.progress(), notes, &input.index_from_world)
                      .front()
                : convert_particles(arguments, stages.progress(), notes);
    });
    note(fmt::format("{}: converted with the default options of vog convert: {} Gaussians", file,
                     count_text(input.model.size())));
    return input;
}

/// Writes a site: the models' chunks, the manifest, and the page.
/// returns  the report of --json
Json export_site(const ExportArguments& arguments, const GivenOptions& command) {
    const FileKind kind = common_kind(arguments.inputs, arguments.volume.grid);
    require_effects(command, facts_of(arguments, kind));
    const std::size_t count = kind == FileKind::model ? arguments.inputs.size() : 1;
    check_names(arguments.page, count);
    refuse_own_folder(arguments.inputs, arguments.output);
    const CommandMemory memory(arguments.memory);
    Stages stages(arguments.verbose);
    std::vector<std::string> notes;
    const WrittenSite site = write_site(
        arguments.output, site_precision(arguments.compact, arguments.page.precise), count,
        [&](std::size_t n) { return read_site_input(arguments, kind, n, stages, notes); },
        [&](const HtmlModel& first) {
            return page_options(arguments.page, command, first, arguments.inputs.front(), notes);
        },
        stages);
    return report_site(arguments.output, !arguments.json, site, stages, notes);
}

/// Writes a page alone, of a site or a compact file whose copy lies at an address.
/// returns  the report of --json
Json export_elsewhere(const ExportArguments& arguments, const GivenOptions& command) {
    require_effects(command, facts_of(arguments, FileKind::model));
    check_output(arguments.output, arguments.inputs, {".html"});
    const std::string& input = arguments.inputs.front();
    const bool site = is_site(input);
    if (arguments.inputs.size() > 1 || (!site && extension_of(input) != ".vogz"))
        throw UsageError(
            "--from: expected one site (a folder) or one compact model (.vogz), whose copy lies at "
            "the address");
    ExportArguments page = arguments;
    if (site && !command.has("--steps")) page.page.steps = read_site_info(input).steps;
    HtmlSource source{arguments.from, !site};
    if (site && !source.url.ends_with('/')) source.url += '/';
    Stages stages(arguments.verbose);
    std::vector<std::string> notes;
    std::vector<HtmlModel> entries = stages.run("load", [&] { return models_to_stream(input); });
    check_names(page.page, entries.size());
    for (std::size_t n = 0; n < page.page.names.size(); ++n) entries[n].name = page.page.names[n];
    const HtmlOptions options = page_options(page.page, command, entries.front(), input, notes);
    const HtmlReport report = stages.run(
        "save", [&] { return write_streaming_page(page.output, entries, source, options); });
    if (!page.json)
        print_line(
            fmt::format("{}: {}, streams {}", page.output, bytes_text(report.bytes), source.url));
    Json json = {{"output", page.output},
                 {"bytes", report.bytes},
                 {"from", source.url},
                 {"extinction", report.extinction}};
    for (const auto& [name, ms] : stages.times()) json["ms"][name] = ms;
    if (!notes.empty()) json["notes"] = notes;
    return json;
}

/// Makes the models of a site the inputs; a file that holds one has the first, which a note says.
void read_models_of_site(ExportArguments& arguments, const GivenOptions& command) {
    const std::string site = arguments.inputs.front();
    const std::vector<std::string> models = models_of_one_site(arguments.inputs);
    if (models.empty()) return;
    if (!is_sequence(arguments.output) && extension_of(arguments.output) != ".html")
        return note_first_model(site, models);
    arguments.inputs = models;
    arguments.site = is_sequence(arguments.output);
    if (!command.has("--steps")) arguments.page.steps = read_site_info(site).steps;
}

void export_files(const ExportArguments& given, const GivenOptions& command) {
    ExportArguments arguments = given;
    arguments.inputs = expanded(given.inputs);
    // Models that one pattern matches are steps in time, named ones are to be compared.
    if (!command.has("--steps") && given.inputs.size() == 1 && arguments.inputs.size() > 1 &&
        (arguments.site || extension_of(arguments.output) == ".html") &&
        common_kind(arguments.inputs, arguments.volume.grid) == FileKind::model) {
        arguments.page.steps = true;
        note(fmt::format("{}: {} models as steps in time (--no-steps: one switch between them)",
                         given.inputs.front(), arguments.inputs.size()));
    }
    if (!command.has("--from")) read_models_of_site(arguments, command);
    std::vector<std::string> read = arguments.inputs;
    read.insert(read.end(), {arguments.page.view.camera_file, arguments.page.words.word("tf")});
    check_distinct({is_sequence(arguments.output) ? "" : arguments.output}, read);
    const ThreadLimit limit(arguments.threads);
    const Json json = command.has("--from")           ? export_elsewhere(arguments, command)
                      : makes_site(arguments)         ? export_site(arguments, command)
                      : is_sequence(arguments.output) ? export_sequence(arguments, command)
                                                      : export_one(arguments, command).json;
    if (arguments.json) print_json(json);
}

}  // namespace

void add_export(CLI::App& app) {
    auto arguments = std::make_shared<ExportArguments>();
    CLI::App* command = app.add_subcommand("export",
                                           "Write models to one self-contained page for a browser, "
                                           "a site that streams large ones, one "
                                           "compact file, one PLY or splats of other programs");
    command
        ->add_option(
            "inputs", arguments->inputs,
            "Models (.ply, .vogz), among which the reader of the page selects; or volumes or "
            "particles, converted with the default options of vog convert. Quoted patterns "
            "match files in natural order: 'frame_*.ply'")
        ->required();
    command
        ->add_option(
            "-o,--output", arguments->output,
            "Page (.html), compact model (.vogz), model (.ply) or splats (.spz, .glb, .usda, "
            ".ply with --as) to write. A folder (or a "
            "name that ends in /): of one input a site, a page that loads parts of the model as "
            "views need them from any web server; of several inputs "
            "one page per input, all under one camera and one extinction, or with --site one site")
        ->required();
    command->add_flag(
        "--site", arguments->site,
        "Write several models as one site, for -o FOLDER/; of one quoted pattern as steps in time");
    command->add_flag("--no-fields", arguments->no_fields,
                      "Leave fields out: a smaller file, without values");
    command
        ->add_option(
            "--budget", arguments->budget,
            "Largest number of Gaussians per model; larger models are coarsened by joining "
            "neighbouring Gaussians")
        ->check(positive_number());
    add_page_options(*command, arguments->page);
    command
        ->add_option("--from", arguments->from,
                     "Address at which a copy of the input lies, a site's folder or a compact "
                     "model written with --hierarchy --deflate: the page streams it from there. Of "
                     "https or http, or relative to the page")
        ->group(kPageGroup);
    command
        ->add_option(setting("levels"), arguments->levels,
                     "Largest number of levels of detail in the page: the model itself, then a "
                     "quarter as many "
                     "Gaussians each time; 1: the model alone")
        ->check(CLI::Range(1, 32))
        ->capture_default_str()
        ->group(kPageGroup);
    add_compact_options(*command, arguments->compact);
    add_splat_options(*command, arguments->splats);
    add_volume_options(*command, arguments->volume);
    add_point_options(*command, arguments->points);
    add_view_options(*command, arguments->page.view);
    add_memory_options(*command, arguments->memory, ". Of sites");
    add_run_options(*command, arguments->threads, arguments->json, arguments->verbose);
    command->callback([arguments, command] { export_files(*arguments, GivenOptions(*command)); });
}

}  // namespace vog::cli
