// evaluate.cpp: vog evaluate: load -> every conversion from every view -> tables and pictures.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "conversion/volume_fields.h"
#include "options/option_effects.h"
#include "options/parser/validators.h"
#include "options/request_options.h"
#include "terminal/terminal.h"
#include "vog/distributed.h"
#include "vog/error.h"

namespace vog::cli {

namespace {

/// Prints one line per conversion: figures of the paper view and the worst PSNR of all views.
void print(const Evaluation& evaluation) {
    print_line(fmt::format("{:<14} {:>10} {:>9} {:>9} {:>9} {:>8} {:>8}", "", "Gaussians", "V, dB",
                           "worst", "L2 of T", "bias", "frames/s"));
    for (const EvaluationRow& row : evaluation.rows) {
        const ViewResult& paper = row.views.front();
        print_line(fmt::format("{:<14} {:>10} {:>9.2f} {:>9.2f} {:>9.4f} {:>8.3f} {:>8.1f}",
                               row.series + " " + row.step, count_text(row.gaussians),
                               paper.psnr_v_db, spread(row, &ViewResult::psnr_v_db, true).worst,
                               paper.relative_l2, paper.bias, 1000 / paper.render.median_ms));
    }
    for (std::size_t n = 0; n < evaluation.fields.size(); ++n) {
        print_line("");
        print_line(fmt::format("{:<20} {:>12} {:>9} {:>12} {:>9}", evaluation.fields[n],
                               "L2 of mean", "worst", "of deviation", "worst"));
        for (const EvaluationRow& row : evaluation.rows) {
            if (row.views.front().fields.empty()) continue;
            const Spread mean = spread(row, n, &FieldResult::mean_l2);
            const Spread deviation = spread(row, n, &FieldResult::deviation_l2);
            print_line(fmt::format("{:<20} {:>12.4f} {:>9.4f} {:>12.4f} {:>9.4f}",
                                   row.series + " " + row.step, mean.mean, mean.worst,
                                   deviation.mean, deviation.worst));
        }
    }
    if (evaluation.voxels) {
        print_line("");
        print_line(fmt::format("{:<20} {:>12} {:>9} {:>12} {:>9}", "voxels", "L2", "PSNR, dB",
                               "mean", "worst"));
        for (const EvaluationRow& row : evaluation.rows)
            if (row.voxels)
                print_line(fmt::format("{:<20} {:>12.4f} {:>9.2f} {:>12.5f} {:>9.4f}",
                                       row.series + " " + row.step, row.voxels->relative_l2,
                                       row.voxels->psnr_db, row.voxels->mean, row.voxels->worst));
    }
    for (std::size_t n = 0; n < evaluation.functions.size(); ++n) {
        print_line("");
        print_line(fmt::format("{:<20} {:>12} {:>9} {:>12} {:>9}", evaluation.functions[n],
                               "RGB, dB", "worst", "SSIM", "worst"));
        for (const EvaluationRow& row : evaluation.rows) {
            if (row.values.empty()) continue;
            const Spread psnr = spread(row, n, &ValueResult::psnr_rgb_db);
            const Spread ssim = spread(row, n, &ValueResult::ssim);
            print_line(fmt::format("{:<20} {:>12.2f} {:>9.2f} {:>12.4f} {:>9.4f}",
                                   row.series + " " + row.step, psnr.mean, psnr.worst, ssim.mean,
                                   ssim.worst));
        }
    }
}

/// Takes the models out of the inputs.
/// throws  UsageError, vog::Error for models without volumes
void take_models(EvaluateArguments& arguments, const EvaluateRanks& ranks) {
    std::vector<std::string> volumes;
    for (const std::string& input : arguments.inputs)
        (kind_of(input, arguments.volume.grid) == FileKind::model ? arguments.models : volumes)
            .push_back(input);
    if (volumes.empty())
        throw Error(
            fmt::format("{}: a model; vog evaluate needs a volume, whose voxels are the reference",
                        arguments.inputs.front()));
    if (ranks.load && !arguments.models.empty())
        throw UsageError(arguments.models.front() +
                         ": vog-mpi does not evaluate models; use vog evaluate");
    arguments.inputs = std::move(volumes);
}

/// Rows of the models, named after their files; of two files of one name the second has a number.
std::vector<Conversion> model_rows(const std::vector<std::string>& models,
                                   const ValueRules& rules) {
    std::vector<Conversion> rows;
    for (const std::string& file : models) {
        const std::string name = std::filesystem::path(file).filename().string();
        std::string step = name;
        for (int n = 2; std::ranges::find(rows, step, &Conversion::step) != rows.end(); ++n)
            step = fmt::format("{}-{}", name, n);
        rows.push_back(model_row(step, load_models({file}, nullptr, {}, rules)));
    }
    return rows;
}

/// --show and --tf, which is of values under --show volume.
void set_transfer_functions(EvaluateArguments& arguments) {
    arguments.options.by_value = arguments.show == "volume";
    if (arguments.options.by_value) {
        arguments.options.value_functions = arguments.tfs;
        return;
    }
    if (arguments.tfs.size() > 1) throw UsageError("--tf: only --show volume takes several");
    if (!arguments.tfs.empty()) arguments.options.tf = arguments.tfs.front();
}

/// Fields of --field with values at every voxel, for EvaluateOptions::read_fields.
std::vector<std::vector<VoxelField>> fields_at(const EvaluateArguments& arguments,
                                               std::vector<Volume>& volumes,
                                               std::vector<std::string>& notes) {
    std::vector<std::vector<VoxelField>> all = read_volume_fields(
        {arguments.fields, arguments.volume.grid, arguments.inputs}, volumes, notes);
    for (std::vector<VoxelField>& field : all)
        for (std::size_t n = 0; n < volumes.size(); ++n)
            if (without_values(field[n])) field[n] = own_field(volumes[n], field[n].name);
    return all;
}

Evaluation evaluated(const EvaluateArguments& arguments, const EvaluateRanks& ranks, Stages& stages,
                     std::vector<std::string>& notes) {
    const LoadedVolumes set = stages.run("load", [&] {
        return ranks.load ? ranks.load(arguments)
                          : load_volumes(arguments.inputs, arguments.volume);
    });
    notes = set.notes;
    print_notes(notes);
    return stages.run("evaluate",
                      [&] { return evaluate(set, arguments.folder, arguments.options); });
}

void evaluate_files(EvaluateArguments& arguments, const EvaluateRanks& ranks) {
    take_models(arguments, ranks);
    set_transfer_functions(arguments);
    if (common_kind(arguments.inputs, arguments.volume.grid) != FileKind::volume)
        throw Error(fmt::format(
            "{}: particles; vog evaluate needs a volume, whose voxels are the reference",
            arguments.inputs.front()));
    if (std::filesystem::exists(arguments.folder) &&
        !std::filesystem::is_directory(arguments.folder))
        throw Error(fmt::format("-o {}: a file; vog evaluate writes a folder", arguments.folder));
    const PictureRequest stated =
        RequestWords{{{"size", {arguments.size}}, {"extinction", {arguments.extinction}}}}.over();
    arguments.options.width = stated.width;
    arguments.options.height = stated.height;
    if (stated.extinction) arguments.options.extinction = *stated.extinction;
    const ThreadLimit limit(arguments.threads);
    if (!arguments.models.empty())
        arguments.options.conversions = model_rows(arguments.models, arguments.volume.values);
    const bool is_root = collective_or_single(ranks.collective).is_root();
    Stages stages(arguments.verbose && is_root);
    arguments.options.progress = stages.progress();
    arguments.options.collective = ranks.collective;
    std::vector<std::string> notes, field_notes;
    if (!arguments.fields.empty())
        arguments.options.read_fields = [&](std::vector<Volume>& volumes) {
            return fields_at(arguments, volumes, field_notes);
        };
    const Evaluation evaluation = evaluated(arguments, ranks, stages, notes);
    if (!is_root) return;
    print_notes(field_notes);
    notes.insert(notes.end(), field_notes.begin(), field_notes.end());

    const std::filesystem::path folder = arguments.folder;
    if (arguments.json) {
        auto json = nlohmann::ordered_json::parse(std::ifstream(folder / "results.json"));
        if (!notes.empty()) json["notes"] = notes;
        print_json(json);
        return;
    }
    print(evaluation);
    print_line((folder / "results.csv").string());
    print_line(
        fmt::format("python -m vog.report {} makes plots and a page from it", folder.string()));
}

}  // namespace

void add_evaluate(CLI::App& app) { add_evaluate(app, std::make_shared<EvaluateArguments>(), {}); }

void add_evaluate(CLI::App& app, const std::shared_ptr<EvaluateArguments>& arguments,
                  const EvaluateRanks& ranks) {
    CLI::App* command = app.add_subcommand("evaluate",
                                           "Measure all conversions of a volume against its "
                                           "voxels, for the paper's tables and pictures");
    command
        ->add_option(
            "inputs", arguments->inputs,
            "Volumes (.vdb, .nvdb, dense images); several: levels or parts of one mesh. If you add "
            "models of them (.ply, .vogz, .json), these are evaluated instead of conversions")
        ->required();
    command
        ->add_option("-o,--output", arguments->folder,
                     "Folder for results.json, results.csv and pictures; python -m vog.report "
                     "FOLDER makes plots and a page from it")
        ->required();
    add_volume_options(*command, arguments->volume);
    command->add_option(
        "--field", arguments->fields,
        "Also compare maps of this field's mean and deviation: a grid of the inputs, FILE:GRID or "
        "NAME=FILE:GRID; for vectors, the component along the view. Repeatable");
    add_value(*command, "--size", arguments->size, "",
              "Size of the pictures in pixels, WxH or one number for a square");
    add_value(*command, "--extinction", arguments->extinction, "",
              "Extinction, or auto, which makes the 99th percentile of the reference's non-zero "
              "optical depth T 4 in each view");
    command
        ->add_option("--tf", arguments->tfs,
                     "Transfer function of the pictures and of the RGB figures: a name or a JSON "
                     "file; default inferno. With --show volume one of values, beside a ramp, "
                     "three narrow bands and an opaque step; repeatable")
        ->allow_extra_args(false);
    add_value(*command, "--show", arguments->show, "T volume",
              "T, or volume: volume pictures are compared too, emission and absorption under "
              "several transfer functions from seven views");
    command->add_flag(
        "--voxels", arguments->options.voxels,
        "Measure the field error too: each model turned back into voxels, as vog voxelize --like "
        "does, against the volume, or the visible voxels of a mesh's levels");
    add_value(*command, "--repeat", arguments->options.repeats, "[1, 1000]",
              "Timed renders per view, after one warm-up");
    command->add_flag("--resume", arguments->options.resume,
                      "Continue an interrupted evaluation: keep the conversions that are finished");
    add_run_options(*command, arguments->threads, arguments->json, arguments->verbose);
    on_run(*command, [arguments, ranks](GivenOptions& given) {
        require_effects(given, {{"input", input_fact(FileKind::volume, arguments->inputs)}});
        arguments->volume.refuse_several = true;  // of another grid the figures would be others
        evaluate_files(*arguments, ranks);
    });
}

}  // namespace vog::cli
