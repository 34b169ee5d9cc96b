// exchange_run.cpp: colours and extinction of splats, their error, and the report.
#include "models/exchange_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "shared/inputs.h"
#include "vog/error.h"
#include "vog/exchange.h"
#include "vog/periodic.h"
#include "vog/picture.h"
#include "vog/shade.h"
#include "vog/text.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

/// Scalar field that colours splats.
const ScalarField& field_of(const Gaussians& model, const std::string& name) {
    if (const ScalarField* field = scalar_to_show(model.fields, name)) return *field;
    if (!name.empty())
        throw Error(fmt::format("--field {}: no scalar field of that name (scalar fields: {})",
                                name, scalar_names(model.fields)));
    throw Error(model.fields.scalar.empty()
                    ? "--tf colours splats by a field, and the model has none: leave --tf out for "
                      "white, or convert with --field"
                    : fmt::format("--tf colours splats by a field: expected --field with one of {}",
                                  scalar_names(model.fields)));
}

/// Colours of the field by the transfer function, none where all are white. Densities are multiplied by the function's
/// opacity, and Gaussians without any are left out.
std::vector<Vec3f> paint(Gaussians& model, const SplatLook& look) {
    if (!look.colored) return {};
    const ScalarField& field = field_of(model, look.field);
    const TransferFunction tf = load_transfer_function(look.tf);
    const double range = field.upper - field.lower;
    std::vector<Vec3f> colors;
    std::vector<std::size_t> visible;
    for (std::size_t i = 0; i < model.size(); ++i) {
        const double share = range > 0 ? (field.value[i] - field.lower) / range : 0;
        const Rgba color = color_at(tf, static_cast<float>(std::clamp(share, 0.0, 1.0)));
        if (!(color.a > 0)) continue;
        model.density[i] *= color.a;
        visible.push_back(i);
        colors.push_back({color.r, color.g, color.b});
    }
    if (visible.empty())
        throw Error(fmt::format("--tf {}: opacity 0 at all values of {}", look.tf, field.name));
    if (visible.size() < model.size()) model = select(model, visible);
    return colors;
}

/// "z" or "-y" of an axis, else "x,y,z".
std::string direction_text(Vec3d v) {
    const Vec3d unit = normalized(v);
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(unit[axis]) == 1)
            return fmt::format("{}{}", unit[axis] < 0 ? "-" : "", "xyz"[axis]);
    return fmt::format("{:.6g},{:.6g},{:.6g}", v.x, v.y, v.z);
}

}  // namespace

bool is_splat_output(const std::string& output, const SplatArguments& arguments) {
    const std::string extension = extension_of(output);
    return extension == ".spz" || extension == ".glb" || extension == ".usda" ||
           (extension == ".ply" && arguments.layout != "vog");
}

Json write_exchange(const std::string& output, Gaussians model, const SplatArguments& arguments,
                    const SplatLook& look, Stages& stages, bool json) {
    model = without_images(std::move(model));
    const bool ply = extension_of(output) == ".ply";
    const double extinction = look.extinction ? *look.extinction : default_extinction(model);
    Json report = {{"output", output}, {"gaussians", model.size()}, {"extinction", extinction}};
    std::string loss, frame = "Units are the data's";
    if (arguments.layout == "volprim") {
        stages.run("save", [&] { write_volprim(output, model, extinction); });
        frame = "Coordinates are the data's.";
        loss =
            fmt::format("Mass is kept; kernels end at 3 standard deviations there, at {:.3g} here.",
                        model.cutoff);
    } else {
        const std::vector<Vec3f> color = paint(model, look);
        report["gaussians"] = model.size();
        const SplatsError error = stages.run("measure", [&] {
            return splats_error(model, splats_of(model, color, {extinction, false}), extinction);
        });
        const Splats splats = splats_of(model, color, {extinction, arguments.units != "world"});
        stages.run("save", [&] { write_splats(output, splats, look.up); });
        const Vec3d center = splats.world_center;
        report["world_scale"] = splats.world_scale;
        report["world_center"] = {center.x, center.y, center.z};
        report["up"] = {look.up.x, look.up.y, look.up.z};
        if (splats.world_scale != 1 || center != Vec3d{})
            frame = fmt::format(
                "1 unit is {:.6g} units of the data, 0 lies at {:.6g}, {:.6g}, {:.6g} there",
                splats.world_scale, center.x, center.y, center.z);
        frame += fmt::format(". {} of the data is up, {} in this format. Splats {}.",
                             direction_text(look.up), ply ? "-y" : "y",
                             look.colored ? "have colours of " + look.tf : "are white");
        report["psnr_v_db"] = {{"mean", error.mean_db}, {"worst", error.worst_db}};
        report["depth_ratio"] = error.depth;
        report["opaque"] = error.opaque;
        loss = fmt::format(
            "Error of V as splats, seven parallel views: PSNR {:.1f} dB, worst {:.1f}; optical "
            "depth {:.3f} of the "
            "model's; {:.3g} % of splats are opaque. Values, deviations and T are lost.",
            error.mean_db, error.worst_db, error.depth, 100 * error.opaque);
    }
    const std::uint64_t bytes = std::filesystem::file_size(output);
    report["bytes"] = bytes;
    for (const auto& [name, ms] : stages.times()) report["ms"][name] = ms;
    if (json) return report;
    print_line(fmt::format("{}: {} splats, {}, extinction {:.6g}", output, count_text(model.size()),
                           bytes_text(bytes), extinction));
    print_line(frame);
    print_line(loss);
    return report;
}

}  // namespace vog::cli
