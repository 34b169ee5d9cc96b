// compact_run.cpp: writing a compact model, and its report.
#include "models/compact_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "shared/inputs.h"
#include "vog/error.h"
#include "vog/lod.h"
#include "vog/picture.h"
#include "vog/vogz_fit.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

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

VogzFit fit(const Gaussians& model, const CompactArguments& arguments) {
    VogzBound bound;
    bound.max_loss_db = arguments.max_loss_db;
    if (arguments.model_psnr_db > 0) bound.model_psnr_db = arguments.model_psnr_db;
    if (arguments.reference.empty()) return fit_vogz(model, bound);
    PictureRenderer reference = load_reference(arguments.reference, arguments.values);
    bound.data = [&](const Camera& camera, int size) {
        return bare_depth(reference, {.camera = camera, .width = size, .height = size});
    };
    return fit_vogz(model, bound);
}

}  // namespace

Json write_compact(const std::string& output, Gaussians model, const CompactArguments& arguments,
                   Stages& stages, bool json) {
    VogzOptions options;
    options.deflate = arguments.deflate;
    Json report = {{"output", output}};
    std::string loss;
    if (arguments.max_loss_db > 0) {
        const VogzFit fitted = stages.run("fit", [&] { return fit(model, arguments); });
        options.precision = fitted.precision;
        constexpr double kUnlike = 20;
        if (!arguments.reference.empty() && fitted.model_db < kUnlike)
            note(
                fmt::format("{}: the model is {:.1f} dB from --reference {}: is it of other data? "
                            "Rounding then loses nothing",
                            output, fitted.model_db, arguments.reference.front()));
        loss = fmt::format(
            "V loses at most {:.3f} dB in seven views {} ({:.1f} dB); rounded against exact: "
            "{:.1f} dB",
            fitted.loss_db,
            arguments.reference.empty() ? "of a model of the PSNR assumed" : "against the data",
            fitted.model_db, fitted.rounded_db);
        report["loss_db"] = fitted.loss_db;
        report["model_db"] = fitted.model_db;
        report["rounded_db"] = fitted.rounded_db;
    }
    if (arguments.step > 0) options.precision.step = arguments.step;
    if (arguments.field_step > 0) options.precision.field_step = arguments.field_step;
    Hierarchy hierarchy;
    if (arguments.hierarchy) {
        std::vector<std::size_t> dense;
        for (std::size_t i = 0; i < model.size(); ++i)
            if (model.density[i] > 0) dense.push_back(i);
        if (dense.size() < model.size()) {
            note(fmt::format("{}: {} Gaussians without density left out", output,
                             count_text(model.size() - dense.size())));
            Gaussians some = select(model, dense);
            some.source_voxels = model.source_voxels;
            some.summary = model.summary;
            model = std::move(some);
        }
        hierarchy = stages.run("hierarchy", [&] { return build_hierarchy(model); });
    }
    const VogzReport made =
        stages.run("save", [&] { return write_vogz(output, model, hierarchy, options); });
    const double count = std::max(1.0, static_cast<double>(made.gaussians));
    const auto each = [&](std::uint64_t bytes) { return static_cast<double>(bytes) / count; };
    report["gaussians"] = made.gaussians;
    report["left_out"] = made.left_out;
    report["bytes"] = made.bytes;
    report["bytes_each"] = {{"shapes", each(made.shapes)}};
    for (const auto& [name, bytes] : made.fields) report["bytes_each"][name] = each(bytes);
    if (made.levels > 0) report["bytes_each"]["hierarchy"] = each(made.levels);
    report["step"] = options.precision.step;
    report["field_step"] = options.precision.field_step;
    for (const auto& [name, ms] : stages.times()) report["ms"][name] = ms;
    if (json) return report;
    std::string parts = fmt::format("{:.2f} bytes a Gaussian", each(made.shapes));
    for (const auto& [name, bytes] : made.fields)
        parts += fmt::format(", {:.2f} for {}", each(bytes), name);
    if (made.levels > 0) parts += fmt::format(", {:.2f} for the hierarchy", each(made.levels));
    print_line(fmt::format("{}: {} Gaussians, {}: {}", output, count_text(made.gaussians),
                           bytes_text(made.bytes), parts));
    if (!loss.empty()) print_line(loss);
    if (made.left_out > 0)
        print_line(fmt::format("{} Gaussians without density left out", count_text(made.left_out)));
    return report;
}

}  // namespace vog::cli
