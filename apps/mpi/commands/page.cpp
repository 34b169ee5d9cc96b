// page.cpp: vog-mpi page: sites, whose chunks each rank writes of its part of the model.
#include <fmt/core.h>

#include <algorithm>

#include "commands/mpi_commands.h"
#include "conversion/volume_conversion.h"
#include "files/inputs.h"
#include "files/outputs.h"
#include "files/sequence.h"
#include "inputs_part.h"
#include "models/page_options.h"
#include "models/site_run.h"
#include "options/conversion_options.h"
#include "options/field_options.h"
#include "options/memory_options.h"
#include "options/option_effects.h"
#include "options/parser/settings.h"
#include "options/parser/validators.h"
#include "rank_files.h"
#include "vog/error.h"
#include "vog/model_io.h"
#include "vog/site.h"

namespace vog::mpi {

namespace {

using cli::FileKind;
using cli::InputModel;

struct SiteArguments {
    cli::ConvertArguments convert;  ///< inputs, output and the conversion of volumes
    cli::PageArguments page;
    cli::RoundingArguments rounding;
    bool site = false;  ///< --site
};

/// throws cli::UsageError and vog::Error for options and inputs that make no site
void check(const SiteArguments& arguments, const cli::GivenOptions& command, FileKind kind) {
    const cli::ConvertArguments& given = arguments.convert;
    if (!cli::is_sequence(given.output))
        throw cli::UsageError(
            fmt::format("-o {}: vog-mpi page writes sites, to a folder (-o site/); vog page writes "
                        "single pages",
                        given.output));
    if (kind == FileKind::points)
        throw Error(fmt::format(
            "{}: particles, expected volumes or models (vog-mpi convert makes a model of them)",
            given.inputs.front()));
    const cli::Facts facts = {{"input", cli::input_fact(kind, given.inputs)},
                              {"conversion", "moments"},
                              {"output", "site"},
                              {"show", word_of(arguments.page.words.show())}};
    cli::require_effects(command, facts);
    cli::check_names(arguments.page, kind == FileKind::model ? given.inputs.size() : 1);
    cli::check_page_options(arguments.page, command);
    cli::refuse_own_folder(given.inputs, given.output);
}

/// Has the page show the first field of --field, which of volumes states where its values come from.
/// returns  kind of the inputs
/// throws   cli::UsageError for several fields of models
FileKind take_field(SiteArguments& arguments) {
    cli::ConvertArguments& convert = arguments.convert;
    const FileKind kind = cli::common_kind(convert.inputs, convert.volume.grid);
    if (convert.fields.empty()) return kind;
    std::string shown = convert.fields.front();
    if (kind == FileKind::volume) {
        shown = cli::parse_field(shown).name;
    } else if (convert.fields.size() > 1) {
        throw cli::UsageError("--field: a page of models shows one field first");
    }
    if (!shown.empty()) arguments.page.words.given["field"] = {shown};
    return kind;
}

/// Describes a part of a model by the whole: texts, box, ranges of fields.
/// throws vog::Error for a part with other fields
void describe(Gaussians& part, const Gaussians& whole) {
    if (part.size() == 0) {
        part = whole;
        return;
    }
    if (part.fields.names() != whole.fields.names())
        throw Error(fmt::format("{}: a part with other fields than the whole", part.source));
    part.box = whole.box;
    part.content = whole.content;
    part.source_voxels = whole.source_voxels;
    part.source = whole.source, part.method = whole.method;
    part.options = whole.options, part.summary = whole.summary;
    const auto take_range = [](auto& own, const auto& all) {
        for (std::size_t k = 0; k < own.size(); ++k)
            own[k].lower = all[k].lower, own[k].upper = all[k].upper;
    };
    take_range(part.fields.scalar, whole.fields.scalar);
    take_range(part.fields.vector, whole.fields.vector);
}

/// This rank's part of the volumes' model.
InputModel convert_input(const SiteArguments& arguments, cli::Stages& stages, const Ranks& ranks,
                         std::vector<std::string>& notes) {
    cli::VolumeConversion conversion;
    conversion.moments = cli::moment_options(arguments.convert);
    conversion.moments.progress = stages.progress();
    ConvertedVolumes volumes = convert_parts(arguments.convert, conversion, stages, ranks);
    notes = volumes.notes;
    InputModel input;
    for (Gaussians& one : volumes.model.inputs)
        if (one.size() > 0) append(input.model, std::exchange(one, {}));
    describe(input.model, volumes.model.description);
    input.index_from_world = volumes.index_from_world;
    if (ranks.first())
        cli::note(fmt::format("{}: {}", arguments.convert.inputs.front(),
                              volumes.model.description.summary));
    return input;
}

/// This rank's part of a model, of which every file is divided among all ranks.
InputModel read_input(const std::string& model, const ValueRules& rules, const Ranks& ranks) {
    const std::vector<std::string> files = cli::model_files({model});
    const SameFiles same(files, ranks);
    InputModel input;
    ValueNotes notes;
    for (const std::string& file : files) {
        if (ranks.count() == 1 && files.size() == 1)
            input.model = read_model(file, &input.hierarchy, rules, &notes);
        else
            append(input.model,
                   read_model(file, ModelPart{ranks.rank(), ranks.count()}, rules, &notes));
    }
    same.check_unchanged();
    note_left_out(notes, files, ranks);
    return input;
}

void write_page(const SiteArguments& given, const cli::GivenOptions& command, const Ranks& ranks) {
    SiteArguments arguments = given;
    cli::ConvertArguments& convert = arguments.convert;
    convert.inputs = cli::expanded(given.convert.inputs);
    const std::vector<std::string> copied = cli::models_of_one_site(convert.inputs);
    if (!copied.empty()) convert.inputs = copied;
    convert.volume.ones = convert.measure == "volume";
    const FileKind kind = take_field(arguments);
    check(arguments, command, kind);
    // As in vog page: models that one pattern matches are steps in time, and those of a site that has steps.
    if (kind == FileKind::model && !command.has("--steps"))
        arguments.page.steps = !copied.empty()
                                   ? read_site_info(given.convert.inputs.front()).steps
                                   : given.convert.inputs.size() == 1 && convert.inputs.size() > 1;
    const cli::CommandMemory memory(convert.memory);
    const ThreadLimit threads(convert.threads);
    cli::Stages stages(convert.verbose && ranks.first());
    std::vector<std::string> notes;
    const auto read = [&](std::size_t n) {
        InputModel input =
            kind == FileKind::volume
                ? convert_input(arguments, stages, ranks, notes)
                : stages.run("load", [&] {
                      return read_input(convert.inputs[n], convert.volume.values, ranks);
                  });
        input.name = cli::model_name(arguments.page, convert.inputs[n], n);
        if (convert.no_fields) input.model.fields = input.hierarchy.nodes.fields = {};
        ranks.agree();
        return input;
    };
    const cli::WrittenSite site = cli::write_site(
        convert.output, cli::site_precision(arguments.rounding, arguments.page.precise),
        kind == FileKind::model ? convert.inputs.size() : 1, read,
        [&](const HtmlModel& first) {
            return cli::page_options(arguments.page, command, first, convert.inputs.front(), notes);
        },
        stages, &ranks.collective());
    if (!ranks.first()) return;
    const auto json = cli::report_site(convert.output, !convert.json, site, stages, notes);
    if (convert.json) cli::print_json(json);
}

void add_volume_conversion(CLI::App& command, cli::ConvertArguments& convert) {
    cli::add_value(command, "--measure", convert.measure, "density volume",
                   "Weight of a voxel. density: its value; volume: 1 for each active voxel");
    cli::add_volume_options(command, convert.volume);
    cli::add_conversion_options(command, convert, true);
    cli::add_memory_options(command, convert.memory, ". Of each rank");
}

}  // namespace

void add_page(CLI::App& app, const Ranks& ranks) {
    auto arguments = std::make_shared<SiteArguments>();
    cli::ConvertArguments& convert = arguments->convert;
    convert.threads = ranks.threads_per_rank();
    CLI::App* command = app.add_subcommand(
        "page", "Write a site that streams large models to browsers; each rank writes its chunks");
    command
        ->add_option(
            "inputs", convert.inputs,
            "Volumes (.vdb, .nvdb; .nii, .nrrd, .mha, .tif, .fits), converted to one model by "
            "parts as vog-mpi convert does; or models (.ply, .vogz, .json), each divided among the "
            "ranks. Quoted patterns match files in natural order, models as steps in time")
        ->required();
    command
        ->add_option("-o,--output", convert.output,
                     "Folder of the site (a name that ends in /), which all ranks share")
        ->required();
    command->add_flag("--site", arguments->site,
                      "Accepted as in vog page; here several models are always one site");
    cli::add_no_fields_option(*command, convert.no_fields);
    add_volume_conversion(*command, convert);
    cli::add_page_options(*command, arguments->page);
    command->remove_option(command->get_option("--field"));
    command
        ->add_option("--field", convert.fields,
                     "Field to show first. Volumes: field that Gaussians carry beside density, as "
                     "for vog-mpi convert: GRID of the same file, FILE:GRID, or NAME=FILE:GRID. "
                     "Repeatable; the first one is shown")
        ->group(cli::kPageGroup);
    cli::add_rounding_options(*command, arguments->rounding);
    cli::add_view_options(*command, arguments->page.view);
    cli::add_run_options(*command, convert.threads, convert.json, convert.verbose);
    cli::on_run(*command, [arguments, &ranks](cli::GivenOptions& given) {
        write_page(*arguments, given, ranks);
    });
}

}  // namespace vog::mpi
