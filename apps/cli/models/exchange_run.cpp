// exchange_run.cpp: colours and extinction of splats, their error, and the report.
#include "models/exchange_run.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "shared/inputs.h"
#include "vog/error.h"
#include "vog/exchange.h"
#include "vog/shade.h"
#include "vog/splat.h"
#include "vog/text.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

/// Scalar field that colours splats; null: none.
const ScalarField* field_of(const Gaussians& model, const std::string& name) {
    if (name.empty()) {
        const auto own = std::ranges::find_if(model.fields.scalar, &ScalarField::is_measure);
        return own == model.fields.scalar.end() ? nullptr : &*own;
    }
    const ScalarField* field = model.fields.find_scalar(name);
    if (!field)
        throw Error(fmt::format("--field {}: no scalar field of that name (the model has: {})",
                                name, fmt::join(model.fields.names(), ", ")));
    return field;
}

std::vector<Vec3f> colors_of(const Gaussians& model, const SplatColors& colors) {
    const ScalarField* field = field_of(model, colors.field);
    if (!field) return {};
    const TransferFunction tf = load_transfer_function(colors.tf);
    const double range = field->upper - field->lower;
    std::vector<Vec3f> result;
    result.reserve(model.size());
    for (const float value : field->value) {
        const double share = range > 0 ? (value - field->lower) / range : 0;
        const Rgba color = color_at(tf, static_cast<float>(std::clamp(share, 0.0, 1.0)));
        result.push_back({color.r, color.g, color.b});
    }
    return result;
}

double extinction_of(const Gaussians& model, const SplatColors& colors) {
    if (colors.extinction) return *colors.extinction;
    constexpr int kSize = 256;
    return auto_extinction(
        render_splat(model, fitted(paper_view(view_box(model)), view_box(model)), kSize, kSize));
}

}  // namespace

void add_splat_options(CLI::App& command, SplatArguments& arguments) {
    command
        .add_option(
            "--as", arguments.layout,
            "Layout of a .ply: vog (exact), 3dgs (splats with opacities, for renderers of 3D "
            "Gaussian splatting) or volprim (volumetric primitives, for Mitsuba)")
        ->check(CLI::IsMember({"vog", "3dgs", "volprim"}))
        ->capture_default_str()
        ->group(kSplatGroup);
    command
        .add_option("--units", arguments.units,
                    "Coordinates of splats: world, those of the data, or box, the model's box "
                    "centred at 0 with a longest edge of 2")
        ->check(CLI::IsMember({"world", "box"}))
        ->capture_default_str()
        ->group(kSplatGroup);
}

bool is_splat_output(const std::string& output, const SplatArguments& arguments) {
    const std::string extension = extension_of(output);
    return extension == ".spz" || extension == ".glb" || extension == ".usda" ||
           extension == ".usdc" || (extension == ".ply" && arguments.layout != "vog");
}

Json write_exchange(const std::string& output, const Gaussians& model,
                    const SplatArguments& arguments, const SplatColors& colors, Stages& stages,
                    bool json) {
    const bool ply = extension_of(output) == ".ply";
    if (ply == (arguments.layout == "vog"))
        throw CLI::ValidationError(
            fmt::format("--as {} does not go with -o {}", arguments.layout, output));
    if (arguments.layout == "volprim" && !colors.field.empty())
        throw CLI::ValidationError("--field does not go with --as volprim");
    const double extinction = extinction_of(model, colors);
    Json report = {{"output", output}, {"gaussians", model.size()}, {"extinction", extinction}};
    std::string loss;
    if (arguments.layout == "volprim") {
        if (arguments.units != "world")
            throw CLI::ValidationError("--units box does not go with --as volprim");
        stages.run("save", [&] { write_volprim(output, model, extinction); });
        loss = fmt::format("mass kept; kernels cut at 3 standard deviations there, at {:.3g} here",
                           model.cutoff);
    } else {
        const std::vector<Vec3f> color = colors_of(model, colors);
        const SplatsError error = stages.run("measure", [&] {
            return splats_error(model, splats_of(model, color, {extinction, false}), extinction);
        });
        stages.run("save", [&] {
            write_splats(output, splats_of(model, color, {extinction, arguments.units == "box"}));
        });
        report["psnr_v_db"] = {{"mean", error.mean_db}, {"worst", error.worst_db}};
        report["depth_ratio"] = error.depth;
        report["opaque"] = error.opaque;
        loss = fmt::format(
            "V as splats, seven parallel views: PSNR {:.1f} dB, worst {:.1f}; optical depth {:.3f} "
            "times the model's, {:.3g} % of "
            "splats opaque; blending makes one colour of a ray's, and values, deviations and T "
            "itself are lost",
            error.mean_db, error.worst_db, error.depth, 100 * error.opaque);
    }
    const std::uint64_t bytes = std::filesystem::file_size(output);
    report["bytes"] = bytes;
    for (const auto& [name, ms] : stages.times()) report["ms"][name] = ms;
    if (json) return report;
    print_line(fmt::format("{}: {} splats, {}, extinction {:.6g}", output, count_text(model.size()),
                           bytes_text(bytes), extinction));
    print_line(loss);
    return report;
}

}  // namespace vog::cli
