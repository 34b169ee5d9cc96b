// rate_run.cpp: options and results of vog evaluate --rate-distortion.
#include "models/rate_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "shared/evaluate_run.h"
#include "shared/terminal.h"
#include "shared/validators.h"
#include "vog/error.h"
#include "vog/evaluate.h"

namespace vog::cli {

namespace {

constexpr const char* kRateGroup = "Bytes and error";

/// One line a file: bytes, PSNR of V and of voxels.
void print_rows(const RateDistortion& results) {
    print_line(fmt::format("{:<17} {:<22} {:>12} {:>9} {:>9} {:>10} {:>10}", "", "", "bytes",
                           "V, dB", "worst", "voxels: L2", "PSNR, dB"));
    for (const RateRow& row : results.rows)
        print_line(fmt::format(
            "{:<17} {:<22} {:>12} {:>9.2f} {:>9.2f} {:>10.4f} {:>10.2f}", row.series, row.step,
            count_text(row.bytes), *rate_figure(row, RateFigure::v_mean),
            *rate_figure(row, RateFigure::v_worst), row.voxels.relative_l2, row.voxels.psnr_db));
    for (const std::string& absent : results.absent) print_line(absent);
}

}  // namespace

void add_rate_options(CLI::App& command, RateArguments& arguments) {
    const OptionGroup grouped(command, kRateGroup);
    CLI::Option* chosen = command.add_flag(
        "--rate-distortion", arguments.chosen,
        "Measure bytes against error in place of conversions: models as .vogz beside the "
        "voxels as .vdb, NanoVDB, ZFP and SZ3, of one volume. Writes rate_distortion.md, "
        ".json, .csv, plots and every file");
    for (const char* other : {"--field", "--show", "--voxels", "--repeat", "--resume"})
        chosen->excludes(command.get_option(other));
    command
        .add_option("--model-sizes", arguments.options.model_sizes,
                    "Number of models, with 1/4096 to 1/8 of the active voxels as Gaussians")
        ->check(CLI::Range(1, 100))
        ->capture_default_str()
        ->needs(chosen);
    command
        .add_option(
            "--tolerances", arguments.options.tolerances,
            "Most tolerances of a codec, each half of the one before, of a PSNR of V from 35 to "
            "58 dB")
        ->check(CLI::Range(1, 100))
        ->capture_default_str()
        ->needs(chosen);
    command
        .add_option("--max-loss", arguments.options.max_loss_db,
                    "Loss of PSNR of V by the rounding of a model's file, dB")
        ->check(positive_number())
        ->capture_default_str()
        ->needs(chosen);
}

void run_rate_distortion(EvaluateArguments& arguments) {
    for (const std::string& input : arguments.inputs)
        if (kind_of(input, arguments.volume.grid) != FileKind::volume)
            throw Error(fmt::format(
                "{}: holds no volume, expected one: --rate-distortion makes its own models",
                input));
    RateDistortionOptions& options = arguments.rate.options;
    options.width = arguments.options.width;
    options.height = arguments.options.height;
    options.extinction = arguments.options.extinction;
    options.value_functions = arguments.tfs;
    Stages stages(arguments.verbose);
    options.progress = stages.progress();
    const LoadedVolumes set =
        stages.run("load", [&] { return load_volumes(arguments.inputs, arguments.volume); });
    if (set.is_mesh() || set.volumes.size() != 1)
        throw Error(fmt::format("{}: {} volumes, expected one: --rate-distortion is of one volume",
                                arguments.inputs.front(), set.volumes.size()));
    print_notes(set.notes);
    const RateDistortion results = stages.run("evaluate", [&] {
        return rate_distortion(set.volumes.front(), arguments.folder, options);
    });
    const std::filesystem::path folder = arguments.folder;
    if (arguments.json) {
        auto json = nlohmann::ordered_json::parse(std::ifstream(folder / "rate_distortion.json"));
        if (!set.notes.empty()) json["notes"] = set.notes;
        print_json(json);
        return;
    }
    print_rows(results);
    print_line((folder / "rate_distortion.md").string());
}

}  // namespace vog::cli
