// field_run.cpp: maps of a field from inputs to files, and their report.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fields/volume_fields.h"
#include "shared/render_run.h"
#include "vog/error.h"
#include "vog/field_maps.h"

namespace vog::cli {

namespace {

/// Inputs with a field, ready for maps.
struct FieldDrawing {
    Drawing drawing;    ///< for views and reports, not for drawing T
    std::string label;  ///< of the shown number: "velocity along the view"
    std::string unit;   ///< of the field
    std::function<FieldMaps(const Camera&, Size, const Progress&)> draw;
};

/// throws CLI::ValidationError and vog::Error for options and renderers that do not draw fields
void check(const RenderArguments& arguments, const CLI::App& command, const Drawing& drawing,
           const RenderRanks& ranks) {
    const std::string show = "--show " + arguments.quantity.show;
    if (ranks.allreduce_max || !ranks.is_root)
        throw CLI::ValidationError(show + ": is of one process, expected vog render");
    if (command.count("--pixel-error"))
        throw CLI::ValidationError("--pixel-error: is of T and column density");
    const std::string& input = arguments.drawing.inputs.front();
    if (drawing.kind == FileKind::points)
        throw Error(fmt::format("{}: holds particles, {} is of models and volumes", input, show));
    if (drawing.kind == FileKind::volume) {
        if (drawing.renderer != Renderer::reference)
            throw Error(fmt::format("{}: {} draws no fields of volumes, expected reference", show,
                                    info_of(drawing.renderer).name));
        if (arguments.drawing.interpolation != "constant")
            throw CLI::ValidationError("--interpolation linear does not go with " + show +
                                       " yet: voxels are constant");
        return;
    }
    if (drawing.renderer != Renderer::splat && drawing.renderer != Renderer::trace)
        throw Error(fmt::format("{}: {} draws no fields, expected splat or trace", show,
                                info_of(drawing.renderer).name));
}

/// "temperature", "velocity along the view", "velocity.x"
std::string label_of(const FieldChoice& choice, const std::string& text) {
    return choice.part == FieldPart::view ? text + " along the view" : text;
}

FieldDrawing load_model(const RenderArguments& arguments, Drawing drawing) {
    const DrawingArguments& given = arguments.drawing;
    const auto model = std::make_shared<Gaussians>(load_models(given.inputs));
    const FieldChoice choice = [&] {
        try {
            return field_choice(arguments.quantity.field, model->fields);
        } catch (const Error& error) {
            throw Error(fmt::format("{}: {}", given.inputs.front(), error.what()));
        }
    }();
    FieldDrawing made;
    const ScalarField* scalar = model->fields.find_scalar(choice.field);
    made.unit = scalar ? scalar->unit : model->fields.find_vector(choice.field)->unit;
    made.label = label_of(choice, arguments.quantity.field);
    drawing.box = view_box(*model);
    drawing.gaussians = model->size();
    set_primitives_text(drawing, 0);
    if (drawing.renderer == Renderer::trace) {
        TraceOptions options;
        options.anyhit = given.anyhit == "collect" ? AnyHit::collect : AnyHit::accumulate;
        const TraceSceneOptions scene{given.aabb_sigma, given.kappa};
        made.draw = [=](const Camera& camera, Size size, const Progress& progress) mutable {
            options.progress = progress;
            return render_field_trace(*model, choice, camera, size.width, size.height, options,
                                      scene);
        };
    } else {
        SplatOptions options;
        options.aabb_sigma = given.aabb_sigma;
        options.kappa = given.kappa;
        made.draw = [=](const Camera& camera, Size size, const Progress& progress) mutable {
            options.progress = progress;
            return render_field_splat(*model, choice, camera, size.width, size.height, options);
        };
    }
    made.drawing = std::move(drawing);
    return made;
}

/// Volumes with their field at every voxel.
struct VolumesWithField {
    std::vector<Volume> volumes;
    std::vector<VoxelField> field;  ///< [volumes]
};

/// The grid in the text of a field: "velocity" of "velocity.x".
std::string grid_text(const std::string& text) {
    const bool part = text.ends_with(".x") || text.ends_with(".y") || text.ends_with(".z");
    return part ? text.substr(0, text.size() - 2) : text;
}

FieldDrawing load_volume_field(const RenderArguments& arguments, Drawing drawing) {
    const DrawingArguments& given = arguments.drawing;
    LoadedVolumes set = load_volumes(given.inputs, given.volume);
    const auto data = std::make_shared<VolumesWithField>();
    if (set.is_mesh()) {
        Composite mesh = composite(set);
        drawing.box = mesh.box;
        data->volumes = std::move(mesh.parts);
    } else {
        data->volumes = std::move(set.volumes);
        for (const Volume& volume : data->volumes) drawing.box.include(world_box(volume));
    }
    const std::string& text = arguments.quantity.field;
    drawing.notes = set.notes;
    data->field = std::move(
        read_volume_fields({{grid_text(text)}, given.volume.grid}, data->volumes, drawing.notes)
            .front());
    print_notes(drawing.notes);
    Fields names;
    const VoxelField& field = data->field.front();
    if (field.is_vector())
        names.vector.emplace_back().name = field.name;
    else
        names.scalar.emplace_back().name = field.name;
    const std::string part = text.substr(grid_text(text).size());
    const FieldChoice choice = field_choice(field.name + part, names);
    FieldDrawing made;
    made.unit = field.unit;
    made.label = label_of(choice, field.name + part);
    for (const Volume& volume : data->volumes) drawing.active_voxels += active_voxels(volume);
    set_primitives_text(drawing, set.is_mesh() ? data->volumes.size() : 0);
    ReferenceOptions options;
    options.samples = given.samples;
    options.clip = clip_of(given);
    made.draw = [=](const Camera& camera, Size size, const Progress& progress) mutable {
        options.progress = progress;
        return render_field_reference(data->volumes, data->field, choice.part, camera, size.width,
                                      size.height, options);
    };
    made.drawing = std::move(drawing);
    return made;
}

/// Values that count for the range: those whose column is at least a thousandth of the largest. Others
/// are the rims of supports, often of extreme values.
std::vector<float> counted(const FieldMaps& maps, const std::vector<float>& shown) {
    const float least = 1e-3f * *std::ranges::max_element(maps.column);
    std::vector<float> values;
    for (std::size_t n = 0; n < shown.size(); ++n)
        if (maps.column[n] > 0 && maps.column[n] >= least) values.push_back(shown[n]);
    return values;
}

/// Values, NaN where the column is below a share of the largest.
std::vector<float> visible(const FieldMaps& maps, std::vector<float> shown, double share) {
    const double least = share * double{*std::ranges::max_element(maps.column)};
    for (std::size_t n = 0; n < shown.size(); ++n)
        if (double{maps.column[n]} < least) shown[n] = std::numeric_limits<float>::quiet_NaN();
    return shown;
}

/// throws vog::Error for a column beyond the range of floats
void require_finite(const FieldMaps& maps, const std::string& input) {
    for (const auto* values : {&maps.column, &maps.mean, &maps.deviation})
        if (std::ranges::any_of(*values, [](float v) { return std::isinf(v); }))
            throw Error(fmt::format(
                "{}: a column or a value of the field beyond the range of 32-bit floats: other "
                "units of values or of length",
                input));
}

void write_numbers(const std::string& file, const FieldMaps& maps,
                   const std::vector<float>& shown) {
    if (file.ends_with(".exr")) {
        const NamedValues channels[] = {
            {"column", maps.column}, {"mean", maps.mean}, {"deviation", maps.deviation}};
        write_channels(file, maps.width, maps.height, channels);
    } else {
        write_map(file, {maps.width, maps.height, shown});
    }
}

/// The picture with --color-bar and --title.
Image pictured(const RenderArguments& arguments, const ValueMap& map, const TransferFunction& tf,
               const ColorScale& scale, const std::string& label) {
    const ShadeOptions shading = shading_of(arguments.color);
    const Image image = shade_map(map, tf, scale, shading);
    const QuantityArguments& given = arguments.quantity;
    if (!given.color_bar && given.title.empty()) return image;
    return annotated(image, tf, scale, {given.title, label, given.color_bar}, shading.background);
}

/// Figures of the shown values in place of T's.
void set_figures(const RenderArguments& arguments, const std::vector<float>& shown,
                 const ColorScale& scale, RenderedPicture& picture) {
    picture.scale = scale;
    picture.above_range = share_above(shown, scale.high);
    picture.values_output = arguments.quantity.values_output;
    double sum = 0, most = -HUGE_VAL;
    std::size_t count = 0;
    for (const float value : shown) {
        if (std::isnan(value)) continue;
        ++count;
        sum += double{value};
        most = std::max(most, double{value});
    }
    picture.mean_t = count ? sum / static_cast<double>(count) : 0;
    picture.max_t = count ? most : 0;
}

}  // namespace

std::optional<RenderedPicture> render_field(const RenderArguments& arguments,
                                            const CLI::App& command, const RenderRanks& ranks) {
    const QuantityArguments& quantity = arguments.quantity;
    const Size size = parse_size(arguments.size);
    const TransferFunction tf = load_transfer_function(arguments.color.tf);
    (void)shading_of(arguments.color);  // checks --background
    const ThreadLimit limit(arguments.threads);
    Stages stages(arguments.verbose);
    const FieldDrawing field = stages.run("load", [&] {
        Drawing drawing = begin_drawing(arguments.drawing, command);
        check(arguments, command, drawing, ranks);
        return drawing.kind == FileKind::model ? load_model(arguments, std::move(drawing))
                                               : load_volume_field(arguments, std::move(drawing));
    });
    const Drawing& drawing = field.drawing;
    const Camera camera = camera_from(arguments.view, command, arguments.box.value_or(drawing.box),
                                      double(size.width) / size.height);
    const Progress progress = arguments.repeat ? Progress{} : stages.progress();
    FieldMaps maps;
    std::vector<double> render_ms = stages.run("render", [&] {
        return timed(arguments, [&] { maps = field.draw(camera, size, progress); });
    });
    require_finite(maps, arguments.drawing.inputs.front());
    const std::vector<float>& shown = quantity.show == "mean" ? maps.mean : maps.deviation;
    const ColorScale scale = [&] {
        const auto fixed = fixed_scale(quantity);
        return fixed ? *fixed : fitted_scale(counted(maps, shown), quantity.fit());
    }();
    const std::string name = quantity.show == "mean" ? field.label : "deviation of " + field.label;
    const std::string unit = quantity.units.empty() ? field.unit : quantity.units;
    if (!arguments.output.empty()) {
        const std::string label = unit.empty() ? name : fmt::format("{} [{}]", name, unit);
        const Image image = stages.run("shade", [&] {
            return pictured(arguments,
                            {maps.width, maps.height, visible(maps, shown, quantity.least_column)},
                            tf, scale, label);
        });
        stages.run("save", [&] { write_image(arguments.output, image); });
    }
    if (!quantity.values_output.empty()) write_numbers(quantity.values_output, maps, shown);
    if (!arguments.view.save_camera.empty()) write_camera(arguments.view.save_camera, camera);
    DepthImage column(maps.width, maps.height);
    column.depth = maps.column;
    RenderedPicture picture =
        figures_of(arguments, drawing, column, std::move(render_ms), stages, scale);
    set_figures(arguments, shown, scale, picture);
    picture.quantity = name;
    picture.units = unit;
    picture.camera = camera;
    return picture;
}

}  // namespace vog::cli
