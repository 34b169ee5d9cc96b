// export.cpp: vog export: models as files of other programs: splats, or Mitsuba's volumetric primitives.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands/commands.h"
#include "files/outputs.h"
#include "files/sequence.h"
#include "models/model_inputs.h"
#include "options/option_effects.h"
#include "options/parser/validators.h"
#include "vog/error.h"
#include "vog/exchange.h"
#include "vog/periodic.h"
#include "vog/picture.h"
#include "vog/shade.h"
#include "vog/surface.h"
#include "vog/text.h"
#include "vog/voxelize.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

struct ExportArguments {
    ModelArguments models;
    std::string layout;  ///< --as, of a .ply: 3dgs or volprim
    std::string units;   ///< world or box; empty: world with volprim, else box
    RequestWords words;  ///< field, tf and extinction
    ViewArguments view;  ///< --up
    std::optional<double> iso;
    double voxel_size = 0;  ///< of a model's surface, world units; 0: its default
};

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

std::string tf_of(const RequestWords& words) { return words.word("tf", default_map(Show::depth)); }

/// Colours of the field by the transfer function, none where all are white. Densities are multiplied by the function's
/// opacity, and Gaussians without any are left out.
std::vector<Vec3f> paint(Gaussians& model, const RequestWords& words) {
    if (!words.has("tf") && !words.has("field")) return {};
    const ScalarField& field = field_of(model, words.word("field"));
    const TransferFunction tf = load_transfer_function(tf_of(words));
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
        throw Error(
            fmt::format("--tf {} makes all values of {} transparent", tf_of(words), field.name));
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

/// Writes splats: units and place in the file, and what they lose, in words.
/// up       upright direction in the data
/// report   receives numbers of both
/// returns  lines to print
std::vector<std::string> write_as_splats(Gaussians& model, const ExportArguments& arguments,
                                         double extinction, Vec3d up, Stages& stages,
                                         Json& report) {
    const std::string& output = arguments.models.output;
    const std::vector<Vec3f> color = paint(model, arguments.words);
    const SplatsError error = stages.run("measure", [&] {
        return splats_error(model, splats_of(model, color, {extinction, false}), extinction);
    });
    const Splats splats = splats_of(model, color, {extinction, arguments.units != "world"});
    stages.run("save", [&] { write_splats(output, splats, up); });
    const Vec3d center = splats.world_center;
    report["world_scale"] = splats.world_scale;
    report["world_center"] = {center.x, center.y, center.z};
    report["up"] = {up.x, up.y, up.z};
    report["psnr_v_db"] = {{"mean", error.mean_db}, {"worst", error.worst_db}};
    report["depth_ratio"] = error.depth;
    report["opaque"] = error.opaque;
    std::string frame = "Units are the data's";
    if (splats.world_scale != 1 || center != Vec3d{})
        frame = fmt::format(
            "1 unit is {:.6g} units of the data; the origin lies at {:.6g}, {:.6g}, {:.6g} in the "
            "data",
            splats.world_scale, center.x, center.y, center.z);
    frame += fmt::format(". {} of the data is up, {} in this format. Splats {}.",
                         direction_text(up), extension_of(output) == ".ply" ? "-y" : "y",
                         color.empty() ? "are white" : "have colours of " + tf_of(arguments.words));
    return {frame, fmt::format("Error of V as splats, seven parallel views: PSNR {:.1f} dB, worst "
                               "{:.1f}; optical depth {:.3f} of the model's; {:.3g} % of splats "
                               "are opaque. Values, deviations and T are lost.",
                               error.mean_db, error.worst_db, error.depth, 100 * error.opaque)};
}

Json write_model(Gaussians model, const ExportArguments& arguments, Stages& stages) {
    const std::string& output = arguments.models.output;
    const Vec3d up = up_of(arguments.view, subject_of(model.box, model.content));
    model = without_images(std::move(model));
    const std::optional<double> given = arguments.words.over().extinction;
    const double extinction = given ? *given : default_extinction(model);
    Json report = {{"output", output}, {"gaussians", model.size()}, {"extinction", extinction}};
    std::vector<std::string> lines;
    if (arguments.layout == "volprim") {
        stages.run("save", [&] { write_volprim(output, model, extinction); });
        lines = {
            "Coordinates are the data's.",
            fmt::format("Mass is kept; kernels end at 3 standard deviations there, at {:.3g} here.",
                        model.cutoff)};
    } else {
        lines = write_as_splats(model, arguments, extinction, up, stages, report);
        report["gaussians"] = model.size();
    }
    const std::uint64_t bytes = std::filesystem::file_size(output);
    report["bytes"] = bytes;
    for (const auto& [name, ms] : stages.times()) report["ms"][name] = ms;
    if (arguments.models.json) return report;
    print_line(fmt::format("{}: {} splats, {}, extinction {:.6g}", output, count_text(model.size()),
                           bytes_text(bytes), extinction));
    for (const std::string& line : lines) print_line(line);
    return report;
}

/// Edge of voxels in which a model's surface is smooth: one and a half times the middle one of its Gaussians' standard deviations, at
/// least a 256th of its box's longest edge.
double smooth_edge(const Gaussians& model) {
    const Box box = view_box(model);
    const Vec3d edges = box.upper - box.lower;
    std::vector<double> sizes;
    for (const Vec3f& s : model.scale) sizes.push_back(std::cbrt(double{s.x} * s.y * s.z));
    if (sizes.empty()) return 1;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::ranges::nth_element(sizes, middle);
    return std::max(1.5 * *middle, std::max({edges.x, edges.y, edges.z}) / 256);
}

/// Volume whose surface is written: the input where it is one volume, else voxels of the inputs' model.
/// voxel_size  of a model, world units; 0: smooth_edge
Volume volume_to_cut(const ModelArguments& models, ModelInputs& inputs, double voxel_size) {
    if (inputs.kind() == FileKind::volume) {
        LoadedVolumes set = load_volumes(models.inputs, models.volume);
        if (set.volumes.size() == 1 && set.masks.empty()) {
            print_notes(set.notes);
            return std::move(set.volumes.front());
        }
    }
    const Gaussians model = inputs.sum();
    const double edge = voxel_size > 0 ? voxel_size : smooth_edge(model);
    Volume volume = voxelize(model, voxel_lattice(model, edge)).volume;
    volume.standing = model.content.standing;
    for (const ScalarField& field : model.fields.scalar)
        if (field.is_measure) volume.background = field.background;
    return volume;
}

/// Writes the surface of --iso.
Json write_isosurface(const ExportArguments& arguments, ModelInputs& inputs, Stages& stages) {
    const std::string& output = arguments.models.output;
    const Volume volume = stages.run(
        "volume", [&] { return volume_to_cut(arguments.models, inputs, arguments.voxel_size); });
    const Surface surface =
        stages.run("surface", [&] { return isosurface(volume, *arguments.iso); });
    stages.run("save", [&] { write_surface(output, surface); });
    const std::uint64_t bytes = std::filesystem::file_size(output);
    if (!arguments.models.json)
        print_line(fmt::format("{}: {} triangles, {} points, {}, world units", output,
                               count_text(surface.triangle.size()),
                               count_text(surface.point.size()), bytes_text(bytes)));
    return {{"output", output},
            {"triangles", surface.triangle.size()},
            {"points", surface.point.size()},
            {"bytes", bytes}};
}

/// throws  vog::Error for OpenUSD's binary layers and for a .ply without --as or --iso
void check_format(const ExportArguments& arguments) {
    const std::string& output = arguments.models.output;
    const std::string extension = extension_of(output);
    if (extension == ".usdc" || extension == ".usd") {
        const std::string text = std::filesystem::path(output).replace_extension(".usda").string();
        throw Error(
            fmt::format("{}: OpenUSD is written as text: vog export -o {}, then usdcat {} -o {}",
                        output, text, text, output));
    }
    check_output(output, arguments.models.inputs,
                 {".spz", ".glb", ".usda", ".ply", ".stl", ".obj"});
    const bool surface =
        extension == ".stl" || extension == ".obj" || arguments.layout == "surface";
    if (surface && !arguments.iso)
        throw UsageError(fmt::format("{}: expected --iso VALUE, the value of the surface", output));
    if (extension == ".ply" && arguments.layout.empty())
        throw UsageError(
            fmt::format("{}: give --as 3dgs, --as volprim or, for a surface, --iso VALUE; to write "
                        "a model, use {}",
                        output, command_line("convert", arguments.models.inputs, output)));
}

void export_files(ExportArguments arguments, const GivenOptions& command) {
    ModelArguments& models = arguments.models;
    models.inputs = expanded(models.inputs);
    if (arguments.iso && arguments.layout.empty()) arguments.layout = "surface";
    check_format(arguments);
    check_distinct({models.output}, {arguments.words.word("tf")});
    const ThreadLimit limit(models.threads);
    Stages stages(models.verbose);
    ModelInputs inputs(models, stages);
    const std::string extension = extension_of(models.output);
    require_effects(command, {{"input", input_fact(inputs.kind(), models.inputs)},
                              {"output", extension == ".ply" ? arguments.layout : extension}});
    Json json = arguments.iso ? write_isosurface(arguments, inputs, stages)
                              : write_model(inputs.sum(), arguments, stages);
    if (!inputs.notes().empty()) json["notes"] = inputs.notes();
    if (models.json) print_json(json);
}

}  // namespace

void add_export(CLI::App& app) {
    auto arguments = std::make_shared<ExportArguments>();
    CLI::App* command =
        app.add_subcommand("export",
                           "Export models to other programs' formats: Gaussian splats (.spz, .glb, "
                           ".usda, .ply), Mitsuba's volumetric primitives (.ply), or surfaces of "
                           "models and volumes (.stl, .obj, .ply)");
    add_model_options(*command, arguments->models,
                      "File to write: .spz, .glb, .usda, .ply with --as; with --iso .stl, .obj or "
                      ".ply. Several inputs are added up");
    add_value(*command, "--as", arguments->layout, "3dgs volprim surface",
              "Layout of a .ply: 3dgs (splats with opacities, for renderers of 3D Gaussian "
              "splatting), volprim (volumetric primitives, for Mitsuba) or surface (of --iso)");
    command->add_option("--iso", arguments->iso,
                        "Write the surface at this density as triangles, in world units");
    add_value(*command, "--voxel-size", arguments->voxel_size, "(0, inf)",
              "Edge of the voxels used to find a model's surface, world units. Default: one and a "
              "half times the median standard deviation of its Gaussians, at least a 256th of its "
              "box's longest edge");
    add_value(*command, "--units", arguments->units, "world box",
              "Coordinates of splats. box: the model's box is centred at 0 with a longest edge of "
              "2, so viewers show it at once. world: those of the data. The file stores the scale. "
              "Default: box; world with --as volprim");
    add_member_options(*command, arguments->words, {"field", "tf", "extinction"});
    command->get_option("--field")->description(
        "Scalar field that colours splats through --tf. Splats are white without --field and --tf");
    add_up_option(*command, arguments->view);
    on_run(*command, [arguments](GivenOptions& given) { export_files(*arguments, given); });
}

}  // namespace vog::cli
