// evaluate.cpp: vog evaluate: load -> every conversion from every view -> tables, plots and
// pictures.
#include <fmt/core.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "fields/volume_fields.h"
#include "shared/evaluate_run.h"
#include "shared/terminal.h"
#include "shared/validators.h"
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
    if (ranks.load) {
        const std::vector<Volume> volumes =
            stages.run("load", [&] { return ranks.load(arguments); });
        return stages.run("evaluate",
                          [&] { return evaluate(volumes, arguments.folder, arguments.options); });
    }
    const LoadedVolumes set =
        stages.run("load", [&] { return load_volumes(arguments.inputs, arguments.volume); });
    notes = set.notes;
    print_notes(notes);
    return stages.run("evaluate", [&] {
        return set.is_mesh() ? evaluate(set, arguments.folder, arguments.options)
                             : evaluate(set.volumes, arguments.folder, arguments.options);
    });
}

void evaluate_files(EvaluateArguments& arguments, const EvaluateRanks& ranks) {
    if (const FileKind kind = common_kind(arguments.inputs, arguments.volume.grid);
        kind != FileKind::volume)
        throw Error(fmt::format("{}: holds {}, expected a volume: its voxels are the reference",
                                arguments.inputs.front(),
                                kind == FileKind::model ? "a model" : "particles"));
    if (std::filesystem::exists(arguments.folder) &&
        !std::filesystem::is_directory(arguments.folder))
        throw Error(fmt::format("{}: is a file, expected a folder as -o", arguments.folder));
    const Size size = parse_size(arguments.size);
    arguments.options.width = size.width;
    arguments.options.height = size.height;
    if (arguments.extinction != "auto")
        arguments.options.extinction = parse_extinction(arguments.extinction);
    const ThreadLimit limit(arguments.threads);
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
    print_line((folder / "index.html").string());
}

}  // namespace

void add_evaluate(CLI::App& app) { add_evaluate(app, std::make_shared<EvaluateArguments>(), {}); }

void add_evaluate(CLI::App& app, const std::shared_ptr<EvaluateArguments>& arguments,
                  const EvaluateRanks& ranks) {
    CLI::App* command = app.add_subcommand(
        "evaluate",
        "Measure all conversions of a volume against its voxels: the paper's tables and plots");
    command
        ->add_option("inputs", arguments->inputs,
                     "Volumes (.vdb, .nvdb); several: levels or parts of one mesh")
        ->required();
    command
        ->add_option("-o,--output", arguments->folder,
                     "Folder to write: results.json, results.md, index.html and pictures")
        ->required();
    add_volume_options(*command, arguments->volume);
    command->add_option(
        "--field", arguments->fields,
        "Field whose maps of mean and deviation are compared too: a grid of the inputs, "
        "FILE:GRID or NAME=FILE:GRID; of vectors the component along the view. Repeatable");
    command
        ->add_option("--size", arguments->size,
                     "Size of the pictures in pixels, WxH or one number for a square")
        ->capture_default_str();
    command
        ->add_option("--extinction", arguments->extinction,
                     "Extinction, the factor on density, or auto: in each view the value at which "
                     "the 99th percentile of the reference's non-zero optical depth T is 4")
        ->capture_default_str();
    command
        ->add_option("--tf", arguments->options.tf,
                     "Transfer function of the pictures and of the RGB figures: a name or a JSON "
                     "file")
        ->capture_default_str();
    command
        ->add_option("--repeat", arguments->options.repeats,
                     "Timed renders per view, after one warm-up")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command->add_flag("--resume", arguments->options.resume,
                      "Continue an interrupted evaluation: keep the conversions that are finished");
    command->add_option("--threads", arguments->threads, "Number of threads; 0: one per core")
        ->check(non_negative_number())
        ->capture_default_str();
    command->add_flag("--json", arguments->json,
                      "Print results.json and nothing else on standard output");
    command->add_flag("--verbose,-v", arguments->verbose,
                      "Print the time of each stage to standard error");
    command->callback([arguments, ranks] { evaluate_files(*arguments, ranks); });
}

}  // namespace vog::cli
