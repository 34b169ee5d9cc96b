// field_run.cpp: maps of a field from inputs to files, and their report.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "fields/value_maps.h"
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
    std::shared_ptr<CutReport> cut{};  ///< of the last picture; null: no hierarchy
};

/// throws CLI::ValidationError and vog::Error for options and renderers that do not draw fields
void check(const RenderArguments& arguments, const Drawing& drawing, const RenderRanks& ranks) {
    const std::string show = "--show " + arguments.quantity.show;
    if (ranks.allreduce_max || !ranks.is_root)
        throw CLI::ValidationError(show + ": is of one process, expected vog render");
    const std::string& input = arguments.drawing.inputs.front();
    if (drawing.kind == FileKind::points)
        throw Error(fmt::format("{}: holds particles, {} is of models and volumes", input, show));
    if (drawing.kind == FileKind::volume) {
        if (drawing.renderer != Renderer::reference)
            throw Error(fmt::format("{}: {} draws no fields of volumes, expected reference", show,
                                    info_of(drawing.renderer).name));
        return;
    }
    if (drawing.renderer != Renderer::splat && drawing.renderer != Renderer::trace)
        throw Error(fmt::format("{}: {} draws no fields, expected splat or trace", show,
                                info_of(drawing.renderer).name));
    if (!clip_of(arguments.drawing).empty())
        throw CLI::ValidationError(
            fmt::format("--clip: {} of models has none, expected volumes, or --show T, column, "
                        "volume or maximum",
                        show));
}

FieldDrawing load_model(const RenderArguments& arguments, Drawing drawing) {
    const DrawingArguments& given = arguments.drawing;
    const bool splats = drawing.renderer == Renderer::splat;
    const auto hierarchy = std::make_shared<Hierarchy>();
    const auto model =
        std::make_shared<Gaussians>(load_models(given.inputs, splats ? hierarchy.get() : nullptr));
    // A model without a hierarchy gets one where --pixel-error is given.
    if (splats && hierarchy->empty() && given.pixel_error) *hierarchy = build_hierarchy(*model);
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
    made.label = field_label(choice);
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
        if (!hierarchy->empty()) {
            options.hierarchy = hierarchy.get();
            options.cut.pixel_error = given.pixel_error.value_or(options.cut.pixel_error);
            made.cut = std::make_shared<CutReport>();
        }
        made.draw = [=, cut = made.cut](const Camera& camera, Size size,
                                        const Progress& progress) mutable {
            options.progress = progress;
            (void)hierarchy;  // the options point to it
            return render_field_splat(*model, choice, camera, size.width, size.height, options,
                                      cut.get());
        };
    }
    made.drawing = std::move(drawing);
    return made;
}

/// Volumes with their field at every voxel.
struct VolumesWithField {
    LoadedVolumes set;
    std::vector<VoxelField> field;  ///< [volumes]
};

/// Length of the part in the text of a field: ".x" of "velocity.x".
std::size_t part_length(const std::string& text) {
    for (const std::string_view part : {".x", ".y", ".z", ".magnitude"})
        if (text.ends_with(part)) return part.size();
    return 0;
}

FieldDrawing load_volume_field(const RenderArguments& arguments, Drawing drawing) {
    const DrawingArguments& given = arguments.drawing;
    const auto data = std::make_shared<VolumesWithField>(load_volumes(given.inputs, given.volume));
    std::vector<Volume>& volumes = data->set.volumes;
    for (const Volume& volume : volumes) {
        if (!volume.empty()) drawing.box.include(world_box(volume));
        drawing.active_voxels += active_voxels(volume);
    }
    const std::string& text = arguments.quantity.field;
    const std::string grid = text.substr(0, text.size() - part_length(text));
    drawing.notes = data->set.notes;
    data->field = std::move(
        read_volume_fields({{grid}, given.volume.grid, given.inputs}, volumes, drawing.notes)
            .front());
    print_notes(drawing.notes);
    Fields names;
    const VoxelField& field = data->field.front();
    if (field.is_vector())
        names.vector.emplace_back().name = field.name;
    else
        names.scalar.emplace_back().name = field.name;
    const FieldChoice choice = field_choice(field.name + text.substr(grid.size()), names);
    FieldDrawing made;
    made.unit = field.unit;
    made.label = field_label(choice);
    set_primitives_text(drawing, data->set.is_mesh() ? volumes.size() : 0);
    ReferenceOptions options;
    options.samples = given.samples;
    options.clip = clip_of(given);
    VoxelGridOptions voxels;
    if (given.interpolation == "linear") voxels.interpolation = Interpolation::linear;
    voxels.step_voxels = given.step_voxels;
    made.draw = [=](const Camera& camera, Size size, const Progress& progress) mutable {
        options.progress = progress;
        const int width = size.width, height = size.height;
        return data->set.is_mesh()
                   ? render_field_reference(data->set, data->field, choice.part, camera, width,
                                            height, options, voxels)
                   : render_field_reference(data->set.volumes, data->field, choice.part, camera,
                                            width, height, options, voxels);
    };
    made.drawing = std::move(drawing);
    return made;
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
        check(arguments, drawing, ranks);
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
        return fixed ? *fixed : fitted_scale(values_for_scale(maps, shown), quantity.fit());
    }();
    const std::string name = quantity.show == "mean" ? field.label : "deviation of " + field.label;
    const std::string unit = quantity.units.empty() ? field.unit : quantity.units;
    if (!arguments.output.empty()) {
        const std::string label = unit.empty() ? name : fmt::format("{} [{}]", name, unit);
        const Image image = stages.run("shade", [&] {
            return map_picture(arguments, visible_values(maps, shown, quantity.least_column), tf,
                               scale, label);
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
    if (field.cut) picture.cut = *field.cut;
    picture.quantity = name;
    picture.units = unit;
    picture.camera = camera;
    return picture;
}

}  // namespace vog::cli
