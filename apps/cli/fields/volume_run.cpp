// volume_run.cpp: pictures by value, emission and absorption, from inputs to files, and their report.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "fields/value_transfer_run.h"
#include "fields/volume_fields.h"
#include "shared/render_run.h"
#include "vog/error.h"
#include "vog/field_maps.h"

namespace vog::cli {

namespace {

/// Picture of the inputs, with progress.
using DrawVolume =
    std::function<VolumeImage(const ValueTransfer&, const Camera&, int, int, const Progress&)>;

/// Inputs with a scalar field, ready for pictures by value.
struct VolumeDrawing {
    Drawing drawing;              ///< for views and reports, not for drawing T
    std::string label;            ///< of the field
    std::string unit;             ///< of the field
    double lower = 0, upper = 0;  ///< least and largest value of the data
    DrawVolume draw;
};

/// throws CLI::ValidationError and vog::Error for options and renderers that do not draw by value
void check_by_value(const RenderArguments& arguments, const CLI::App& command,
                    const Drawing& drawing, const RenderRanks& ranks) {
    if (ranks.allreduce_max || !ranks.is_root)
        throw CLI::ValidationError("--show volume: is of one process, expected vog render");
    if (command.count("--pixel-error"))
        throw CLI::ValidationError("--pixel-error: is of T and column density");
    const std::string& input = arguments.drawing.inputs.front();
    if (drawing.kind == FileKind::points)
        throw Error(
            fmt::format("{}: holds particles, --show volume is of models and volumes", input));
    if (drawing.kind == FileKind::volume) {
        if (drawing.renderer != Renderer::reference)
            throw Error(
                fmt::format("--show volume: {} draws no volumes by value, expected reference",
                            info_of(drawing.renderer).name));
        if (arguments.drawing.interpolation != "constant")
            throw CLI::ValidationError(
                "--interpolation linear does not go with --show volume yet: voxels are constant");
    }
}

/// The field of --field, else the model's density, else its only scalar field.
/// throws  vog::Error naming the fields there are, and how to make one
const ScalarField& field_of(const Fields& fields, const std::string& name,
                            const std::string& input) {
    if (const ScalarField* found = fields.find_scalar(name)) return *found;
    const auto measure = std::ranges::find(fields.scalar, true, &ScalarField::is_measure);
    if (name.empty() && measure != fields.scalar.end()) return *measure;
    if (name.empty() && fields.scalar.size() == 1) return fields.scalar.front();
    std::string names;
    for (const ScalarField& field : fields.scalar)
        names += (names.empty() ? "" : ", ") + printable(field.name);
    const std::string has = names.empty()
                                ? "the model has none; vog convert IN -o model.ply --field " +
                                      (name.empty() ? std::string("GRID") : printable(name))
                                : fmt::format("it has: {}; --field NAME", names);
    throw Error(fmt::format("{}: --show volume needs a scalar field{} ({})", input,
                            name.empty() ? "" : fmt::format(" '{}'", printable(name)), has));
}

/// The renderers of models by value: the one place that knows them.
/// throws  CLI::ValidationError and vog::Error for options and renderers that draw no model by value
DrawVolume model_renderer(const RenderArguments& arguments, Renderer renderer,
                          const std::shared_ptr<const Gaussians>& model, const std::string& field) {
    const DrawingArguments& given = arguments.drawing;
    VolumeLook look = look_of(arguments.value);
    look.clip = clip_of(given);
    if (renderer == Renderer::trace) {
        if (arguments.value.slabs)
            throw CLI::ValidationError("--slabs: is of splat, trace draws in exact order");
        const TraceSceneOptions scene{given.aabb_sigma, given.kappa};
        return [=](const ValueTransfer& transfer, const Camera& camera, int width, int height,
                   const Progress& progress) {
            TraceOptions options;
            options.progress = progress;
            return render_volume_trace(*model, field, transfer, camera, width, height, options,
                                       scene, look);
        };
    }
    if (renderer != Renderer::splat)
        throw Error(
            fmt::format("--show volume: {} draws no models by value, expected splat or trace",
                        info_of(renderer).name));
    if (given.aabb_sigma != 0)
        throw CLI::ValidationError("--aabb-sigma: is of T, column density and trace");
    SlabOptions options;
    options.slabs = arguments.value.slabs.value_or(options.slabs);
    options.kappa = given.kappa;
    options.look = look;
    // Made with the first transfer function, then kept for pictures under others.
    const auto kept = std::make_shared<std::optional<SlabRenderer>>();
    return [=](const ValueTransfer& transfer, const Camera& camera, int width, int height,
               const Progress& progress) {
        if (*kept)
            (*kept)->set_transfer(transfer);
        else
            kept->emplace(*model, field, transfer, options);
        VolumeImage image = (*kept)->render(camera, width, height);
        if (progress) progress(1);
        return image;
    };
}

VolumeDrawing load_model_by_value(const RenderArguments& arguments, Drawing drawing) {
    const std::string& input = arguments.drawing.inputs.front();
    const auto model = std::make_shared<Gaussians>(load_models(arguments.drawing.inputs));
    const ScalarField& field = field_of(model->fields, arguments.quantity.field, input);
    VolumeDrawing made;
    made.label = field.name;
    made.unit = field.unit;
    made.lower = field.lower, made.upper = field.upper;
    made.draw = model_renderer(arguments, drawing.renderer, model, field.name);
    drawing.box = view_box(*model);
    drawing.gaussians = model->size();
    set_primitives_text(drawing, 0);
    made.drawing = std::move(drawing);
    return made;
}

/// Volumes with a scalar field at every voxel.
struct VolumesByValue {
    std::vector<Volume> volumes;
    std::vector<VoxelField> field;  ///< [volumes]
};

/// Sets a scalar field's range: its values at active voxels.
void set_range(const Volume& volume, VoxelField& field) {
    float lower = HUGE_VALF, upper = -HUGE_VALF;
    const auto include = [&](float value) {
        lower = std::min(lower, value), upper = std::max(upper, value);
    };
    const VoxelValues& values = field.component[0];
    for (std::size_t l = 0; l < values.leaf.size(); ++l)
        for (int n = 0; n < kLeafVoxels; ++n)
            if (volume.leaves[l].active(n)) include(values.leaf[l][static_cast<std::size_t>(n)]);
    std::ranges::for_each(values.tile, include);
    field.lower = double{lower}, field.upper = double{upper};
}

/// Reads the field of --field: "temperature", or "velocity.x" of a vector field.
std::vector<VoxelField> read_field_of(const RenderArguments& arguments,
                                      std::vector<Volume>& volumes,
                                      std::vector<std::string>& notes) {
    const std::string& text = arguments.quantity.field;
    if (text.empty()) return own_values(volumes);
    const bool part = text.ends_with(".x") || text.ends_with(".y") || text.ends_with(".z");
    const std::string grid = part ? text.substr(0, text.size() - 2) : text;
    std::vector<VoxelField> fields = std::move(
        read_volume_fields({{grid}, arguments.drawing.volume.grid, arguments.drawing.inputs},
                           volumes, notes)
            .front());
    for (VoxelField& field : fields) {
        if (field.is_vector() != part)
            throw Error(fmt::format(
                "{}: field '{}' is {}, --show volume needs a scalar{}",
                arguments.drawing.inputs.front(), printable(field.name),
                part ? "scalar and has no .x" : "a vector",
                part ? "" : fmt::format(": {0}.x, {0}.y or {0}.z", printable(field.name))));
        if (!part) continue;
        VoxelValues component =
            std::move(field.component[static_cast<std::size_t>(text.back() - 'x')]);
        field.component.assign(1, std::move(component));
        field.name = text;
        set_range(volumes[static_cast<std::size_t>(&field - fields.data())], field);
    }
    return fields;
}

/// A volume with values below 0, which are no densities: every active voxel counts as 1, and the values are a field.
/// returns  nothing for other volumes
std::optional<std::pair<LoadedVolumes, VoxelField>> load_signed(const RenderArguments& arguments) {
    const DrawingArguments& given = arguments.drawing;
    if (given.volume.values.clip_negative || given.volume.level_set_to_fog) return std::nullopt;
    VolumeInputOptions options = given.volume;
    options.ones = true;
    LoadedVolumes set = load_volumes(given.inputs, options);
    Volume& volume = set.volumes.front();
    const std::string& text = arguments.quantity.field;
    if (set.volumes.size() > 1 || set.is_mesh() || !(text.empty() || text == volume.name))
        return std::nullopt;
    VoxelField field = read_field({.file = volume.source, .grid = volume.name}, volume);
    if (!(field.lower < 0) || field.is_vector()) return std::nullopt;
    set.notes.push_back(
        fmt::format("{}: values from {:.6g} to {:.6g}: no density, every active voxel counts alike",
                    given.inputs.front(), field.lower, field.upper));
    return std::pair{std::move(set), std::move(field)};
}

VolumeDrawing load_volume_by_value(const RenderArguments& arguments, Drawing drawing) {
    const DrawingArguments& given = arguments.drawing;
    std::optional<VoxelField> signed_field;
    LoadedVolumes set = [&] {
        try {
            return load_volumes(given.inputs, given.volume);
        } catch (const Error&) {
            auto loaded = load_signed(arguments);
            if (!loaded) throw;
            signed_field = std::move(loaded->second);
            return std::move(loaded->first);
        }
    }();
    const auto data = std::make_shared<VolumesByValue>();
    if (set.is_mesh()) {
        Composite mesh = composite(set);
        drawing.box = mesh.box;
        data->volumes = std::move(mesh.parts);
    } else {
        data->volumes = std::move(set.volumes);
        for (const Volume& volume : data->volumes) drawing.box.include(world_box(volume));
    }
    drawing.notes = set.notes;
    if (signed_field)
        data->field.push_back(std::move(*signed_field));
    else
        data->field = read_field_of(arguments, data->volumes, drawing.notes);
    print_notes(drawing.notes);
    VolumeDrawing made;
    made.unit = data->field.front().unit;
    made.label = data->field.front().name;
    made.lower = HUGE_VAL, made.upper = -HUGE_VAL;
    for (const VoxelField& field : data->field) {
        made.lower = std::min(made.lower, field.lower);
        made.upper = std::max(made.upper, field.upper);
    }
    for (const Volume& volume : data->volumes) drawing.active_voxels += active_voxels(volume);
    set_primitives_text(drawing, set.is_mesh() ? data->volumes.size() : 0);
    ReferenceOptions options;
    options.samples = given.samples;
    VolumeLook look = look_of(arguments.value);
    look.clip = clip_of(given);
    made.draw = [=](const ValueTransfer& transfer, const Camera& camera, int width, int height,
                    const Progress& progress) mutable {
        options.progress = progress;
        return render_volume_reference(data->volumes, data->field, transfer, camera, width, height,
                                       options, look);
    };
    made.drawing = std::move(drawing);
    return made;
}

/// Alpha of a picture, as the figures of reports take T.
DepthImage alpha_of(const VolumeImage& picture) {
    DepthImage alpha(picture.width, picture.height);
    std::ranges::transform(picture.pixel, alpha.depth.begin(), &Rgba::a);
    return alpha;
}

}  // namespace

std::optional<RenderedPicture> render_volume(const RenderArguments& arguments,
                                             const CLI::App& command, const RenderRanks& ranks) {
    const Size size = parse_size(arguments.size);
    const ShadeOptions shading = shading_of(arguments.color);
    const ThreadLimit limit(arguments.threads);
    Stages stages(arguments.verbose);
    VolumeDrawing volume = stages.run("load", [&] {
        Drawing drawing = begin_drawing(arguments.drawing, command);
        check_by_value(arguments, command, drawing, ranks);
        return drawing.kind == FileKind::model
                   ? load_model_by_value(arguments, std::move(drawing))
                   : load_volume_by_value(arguments, std::move(drawing));
    });
    Drawing& drawing = volume.drawing;
    const Box box = arguments.box.value_or(drawing.box);
    const Camera camera =
        camera_from(arguments.view, command, box, double(size.width) / size.height);
    const ValueData data{arguments.drawing.inputs.front(), volume.lower, volume.upper,
                         2 * box.radius()};
    const ChosenTransfer chosen = stages.run("transfer function", [&] {
        const auto draw = [&](const ValueTransfer& transfer, const Camera& from, int width,
                              int height) {
            return volume.draw(transfer, from, width, height, {});
        };
        return choose_transfer(arguments, command, data, draw, camera, size);
    });
    print_notes(chosen.notes);
    drawing.notes.insert(drawing.notes.end(), chosen.notes.begin(), chosen.notes.end());

    const Progress progress = arguments.repeat ? Progress{} : stages.progress();
    VolumeImage image;
    std::vector<double> render_ms = stages.run("render", [&] {
        return timed(arguments, [&] {
            image = volume.draw(chosen.transfer, camera, size.width, size.height, progress);
        });
    });
    if (!arguments.output.empty())
        stages.run("save", [&] { write_image(arguments.output, over(image, shading.background)); });
    if (!arguments.view.save_camera.empty()) write_camera(arguments.view.save_camera, camera);
    const ColorScale scale{ColorScale::Kind::linear, chosen.lower, chosen.upper};
    RenderedPicture picture =
        figures_of(arguments, drawing, alpha_of(image), std::move(render_ms), stages, scale);
    picture.quantity = "volume of " + volume.label;
    picture.units = volume.unit;
    picture.scale = scale;
    picture.unit_distance = chosen.transfer.unit_distance;
    picture.mean_opacity = mean_opacity(image);
    picture.camera = camera;
    return picture;
}

}  // namespace vog::cli
