// pack.cpp: vog pack: a compact model, rounded within a bound on its error, and its report.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "files/outputs.h"
#include "files/sequence.h"
#include "models/model_inputs.h"
#include "options/option_effects.h"
#include "options/parser/settings.h"
#include "options/parser/validators.h"
#include "vog/error.h"
#include "vog/export_html.h"
#include "vog/picture.h"
#include "vog/vogz_fit.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

struct PackArguments {
    ModelArguments models;
    RoundingArguments rounding;
    double max_loss_db = 0;              ///< 0: none, the steps hold
    std::vector<std::string> reference;  ///< volumes that the loss is measured against
    double model_psnr_db = 0;            ///< assumed without a reference
    bool hierarchy = false, deflate = false;
};

/// FILE or FILE:GRID.
std::pair<std::string, std::string> file_and_grid(const std::string& text) {
    const std::size_t colon = text.rfind(':');
    if (colon == std::string::npos || std::filesystem::exists(text)) return {text, ""};
    return {text.substr(0, colon), text.substr(colon + 1)};
}

/// Volumes of --reference.
PictureRenderer load_reference(const std::vector<std::string>& texts, const ValueRules& rules) {
    std::vector<std::string> files;
    VolumeInputOptions options;
    options.values = rules;
    for (const std::string& text : texts) {
        const auto [file, grid] = file_and_grid(text);
        if (!files.empty() && grid != options.grid)
            throw Error(fmt::format("--reference {}: grid '{}', expected '{}' as in {}", text, grid,
                                    options.grid, texts.front()));
        options.grid = grid;
        files.push_back(file);
    }
    for (const std::string& file : files)
        if (kind_of(file, options.grid) != FileKind::volume)
            throw Error(fmt::format("--reference {}: expected a volume (.vdb, .nvdb)", file));
    LoadedVolumes set = load_volumes(files, options);
    print_notes(set.notes);
    return PictureRenderer(scene_of(std::make_shared<const VolumeSet>(std::move(set))));
}

VogzFit fit(const Gaussians& model, const PackArguments& arguments) {
    VogzBound bound;
    bound.max_loss_db = arguments.max_loss_db;
    if (arguments.model_psnr_db > 0) bound.model_psnr_db = arguments.model_psnr_db;
    if (arguments.reference.empty()) return fit_vogz(model, bound);
    PictureRenderer reference = load_reference(arguments.reference, arguments.models.volume.values);
    bound.data = [&](const Camera& camera, int size) {
        return bare_depth(reference, {.camera = camera, .width = size, .height = size});
    };
    return fit_vogz(model, bound);
}

/// Leaves out the Gaussians without density, which no hierarchy holds.
void keep_dense(Gaussians& model, const std::string& output) {
    std::vector<std::size_t> dense;
    for (std::size_t i = 0; i < model.size(); ++i)
        if (model.density[i] > 0) dense.push_back(i);
    if (dense.size() == model.size()) return;
    note(fmt::format("{}: {} Gaussians without density left out", output,
                     count_text(model.size() - dense.size())));
    Gaussians some = select(model, dense);
    some.source_voxels = model.source_voxels;
    some.summary = model.summary;
    model = std::move(some);
}

/// Steps that keep the loss below --max-loss, and a line on it in words.
VogzPrecision fit(const Gaussians& model, const PackArguments& arguments, Stages& stages,
                  Json& report, std::string& loss) {
    const std::string& output = arguments.models.output;
    const VogzFit fitted = stages.run("fit", [&] { return fit(model, arguments); });
    constexpr double kUnlike = 20;
    if (!arguments.reference.empty() && fitted.model_db < kUnlike)
        note(
            fmt::format("{}: the model is {:.1f} dB from --reference {}: does it come from other "
                        "data? Rounding then loses nothing",
                        output, fitted.model_db, arguments.reference.front()));
    loss = fmt::format(
        "V loses at most {:.3f} dB in seven views {} ({:.1f} dB); rounded against exact: {:.1f} dB",
        fitted.loss_db,
        arguments.reference.empty() ? "of a model of the PSNR assumed" : "against the data",
        fitted.model_db, fitted.rounded_db);
    report["loss_db"] = fitted.loss_db;
    report["model_db"] = fitted.model_db;
    report["rounded_db"] = fitted.rounded_db;
    return fitted.precision;
}

Json write_compact(Gaussians model, const PackArguments& arguments, Stages& stages) {
    const std::string& output = arguments.models.output;
    VogzOptions options;
    options.deflate = arguments.deflate;
    Json report = {{"output", output}};
    std::string loss;
    if (arguments.max_loss_db > 0) options.precision = fit(model, arguments, stages, report, loss);
    if (arguments.rounding.step > 0) options.precision.step = arguments.rounding.step;
    if (arguments.rounding.field_step > 0)
        options.precision.field_step = arguments.rounding.field_step;
    Hierarchy hierarchy;
    if (arguments.hierarchy) {
        keep_dense(model, output);
        hierarchy = stages.run("hierarchy", [&] { return build_hierarchy(model); });
        if (options.deflate)
            options.page = page_of_file(prepare_for_site(model_name(output), model, hierarchy));
    }
    const VogzReport made =
        stages.run("save", [&] { return write_vogz(output, model, hierarchy, options); });
    const double count = std::max(1.0, static_cast<double>(made.gaussians));
    const auto each = [&](std::uint64_t bytes) { return static_cast<double>(bytes) / count; };
    report["gaussians"] = made.gaussians;
    report["left_out"] = made.left_out;
    report["bytes"] = made.bytes;
    report["bytes_each"] = {{"shapes", each(made.shapes)}};
    std::string parts = fmt::format("{:.2f} bytes a Gaussian", each(made.shapes));
    const auto add_part = [&](const std::string& name, const char* article, std::uint64_t bytes) {
        report["bytes_each"][name] = each(bytes);
        parts += fmt::format(", {:.2f} for {}{}", each(bytes), article, name);
    };
    for (const auto& [name, bytes] : made.fields) add_part(name, "", bytes);
    if (made.levels > 0) add_part("hierarchy", "the ", made.levels);
    report["step"] = options.precision.step;
    report["field_step"] = options.precision.field_step;
    for (const auto& [name, ms] : stages.times()) report["ms"][name] = ms;
    if (arguments.models.json) return report;
    print_line(fmt::format("{}: {} Gaussians, {}: {}", output, count_text(made.gaussians),
                           bytes_text(made.bytes), parts));
    if (!loss.empty()) print_line(loss);
    if (made.left_out > 0)
        print_line(fmt::format("{} Gaussians without density left out", count_text(made.left_out)));
    return report;
}

void pack(PackArguments arguments, const GivenOptions& command) {
    ModelArguments& models = arguments.models;
    models.inputs = expanded(models.inputs);
    check_output(models.output, models.inputs, {".vogz"});
    const ThreadLimit limit(models.threads);
    Stages stages(models.verbose);
    ModelInputs inputs(models, stages);
    require_effects(command, {{"input", input_fact(inputs.kind(), models.inputs)}});
    Json json = write_compact(inputs.sum(), arguments, stages);
    if (!inputs.notes().empty()) json["notes"] = inputs.notes();
    if (models.json) print_json(json);
}

}  // namespace

void add_pack(CLI::App& app) {
    auto arguments = std::make_shared<PackArguments>();
    CLI::App* command = app.add_subcommand(
        "pack", "Pack models into one compact file (.vogz), rounded within an error limit");
    add_model_options(*command, arguments->models,
                      "Compact model to write (.vogz); several inputs are added up");
    add_no_fields_option(*command, arguments->models.no_fields);
    const OptionGroup grouped(*command, "Precision and layout");
    CLI::Option* loss =
        add_value(*command, "--max-loss", arguments->max_loss_db, "(0, inf)",
                  "Find the coarsest rounding that loses at most this much PSNR of V against the "
                  "data in seven views, dB. Default: --set rounding, about 0.1 dB");
    CLI::Option* reference = command
                                 ->add_option("--reference", arguments->reference,
                                              "With --max-loss: the data, volumes as FILE or "
                                              "FILE:GRID (several: levels of one mesh). Repeatable")
                                 ->needs(loss);
    add_value(*command, setting("model-psnr"), arguments->model_psnr_db, "(0, inf)",
              "With --max-loss and no --reference: the assumed PSNR of V of the model against its "
              "data, dB; default 50")
        ->needs(loss)
        ->excludes(reference);
    add_rounding_options(*command, arguments->rounding);
    command->get_option(setting("rounding"))->excludes(loss);
    command->add_flag("--hierarchy", arguments->hierarchy,
                      "Write the level-of-detail hierarchy, so readers can load parts of the file. "
                      "Without it they build their own");
    command->add_flag("--deflate", arguments->deflate,
                      "Compress with deflate, which browsers have built in, instead of zstd");
    on_run(*command, [arguments](GivenOptions& given) { pack(*arguments, given); });
}

}  // namespace vog::cli
