// field_run.cpp: maps of a field from inputs to files, and their report.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "fields/divided_models.h"
#include "fields/volume_fields.h"
#include "shared/render_run.h"
#include "values/value_maps.h"
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
    (void)clip_of(arguments.drawing);  // refused before anything is read
    require_addable(arguments, drawing, ranks);
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
}

/// Maps of a model's field, of all parts on the root.
using DrawMaps = std::function<FieldMaps(const FieldChoice&, const Camera&, Size, const Progress&)>;

/// Maps of the joint root mean square of a vector field, by its components: its deviation is about the joint mean.
FieldMaps joint_magnitude(const DrawMaps& draw, const std::string& field, const Camera& camera,
                          Size size, const Progress& progress, const RenderRanks& ranks) {
    FieldMaps all;
    for (const FieldPart part : {FieldPart::x, FieldPart::y, FieldPart::z}) {
        FieldMaps one = draw({field, part}, camera, size, progress);
        join_maps(one, ranks);
        const bool first = all.column.empty();
        for (std::size_t n = 0; n < one.column.size(); ++n) {
            const float square = one.deviation[n] * one.deviation[n];
            one.mean[n] = one.mean[n] * one.mean[n] + square + (first ? 0 : all.mean[n]);
            one.deviation[n] = square + (first ? 0 : all.deviation[n]);
        }
        all = std::move(one);
    }
    for (auto* squares : {&all.mean, &all.deviation})
        for (float& value : *squares) value = std::sqrt(value);
    return all;
}

/// Maps of all parts, on the root.
FieldMaps joint_maps(const DrawMaps& draw, const FieldChoice& choice, const Camera& camera,
                     Size size, const Progress& progress, const RenderRanks& ranks) {
    if (choice.part == FieldPart::magnitude && ranks.divided())
        return joint_magnitude(draw, choice.field, camera, size, progress, ranks);
    FieldMaps maps = draw(choice, camera, size, progress);
    join_maps(maps, ranks);
    return maps;
}

FieldDrawing load_model(const RenderArguments& arguments, Drawing drawing,
                        const RenderRanks& ranks) {
    const DrawingArguments& given = arguments.drawing;
    const bool splats = drawing.renderer == Renderer::splat;
    const auto hierarchy = std::make_shared<Hierarchy>();
    const auto model = std::make_shared<Gaussians>(
        load_model_part(arguments, drawing, ranks, splats ? hierarchy.get() : nullptr));
    // A model without a hierarchy gets one where --pixel-error is given.
    if (splats && hierarchy->empty() && given.pixel_error && model->size() > 0)
        *hierarchy = build_hierarchy(*model);
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
    const Clipping clip = clip_of(given);
    DrawMaps draw;
    if (drawing.renderer == Renderer::trace) {
        TraceOptions options;
        options.anyhit = given.anyhit == "collect" ? AnyHit::collect : AnyHit::accumulate;
        const TraceSceneOptions scene{given.aabb_sigma, given.kappa};
        draw = [=](const FieldChoice& shown, const Camera& camera, Size size,
                   const Progress& progress) mutable {
            options.progress = progress;
            return render_field_trace(*model, shown, camera, size.width, size.height, options,
                                      scene, clip);
        };
    } else {
        SplatOptions options;
        options.aabb_sigma = given.aabb_sigma;
        options.kappa = given.kappa;
        if (!hierarchy->empty()) {
            options.hierarchy = hierarchy.get();
            options.cut.pixel_error = given.pixel_error.value_or(options.cut.pixel_error);
            if (!ranks.divided()) made.cut = std::make_shared<CutReport>();
        }
        draw = [=, cut = made.cut](const FieldChoice& shown, const Camera& camera, Size size,
                                   const Progress& progress) mutable {
            options.progress = progress;
            (void)hierarchy;  // the options point to it
            return render_field_splat(*model, shown, camera, size.width, size.height, options,
                                      cut.get(), clip);
        };
    }
    made.draw = [=](const Camera& camera, Size size, const Progress& progress) {
        return joint_maps(draw, choice, camera, size, progress, ranks);
    };
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

std::vector<RenderedPicture> render_field(const RenderArguments& arguments, const CLI::App& command,
                                          const RenderRanks& ranks) {
    return render_map(arguments, command, ranks, [&] {
        Drawing drawing = begin_drawing(arguments.drawing, command);
        check(arguments, drawing, ranks);
        FieldDrawing field = drawing.kind == FileKind::model
                                 ? load_model(arguments, std::move(drawing), ranks)
                                 : load_volume_field(arguments, std::move(drawing));
        const bool is_mean = arguments.quantity.show == "mean";
        const auto maps = std::make_shared<FieldMaps>();
        MapDrawing made;
        made.draw = [=, draw = field.draw](const Camera& camera, Size size,
                                           const Progress& progress) {
            *maps = draw(camera, size, progress);
        };
        made.picture = [=, &arguments, label = field.label, unit = field.unit,
                        cut = field.cut](const QuantityArguments& quantity) {
            require_finite(*maps, arguments.drawing.inputs.front());
            const std::vector<float>& shown = is_mean ? maps->mean : maps->deviation;
            const auto fixed = fixed_scale(quantity);
            MapPicture picture{
                is_mean ? label : "deviation of " + label,
                unit,
                visible_values(*maps, shown, quantity.least_column),
                shown,
                DepthImage(maps->width, maps->height),
                fixed ? *fixed : fitted_scale(values_for_scale(*maps, shown), quantity.fit())};
            picture.covered.depth = maps->column;
            if (cut) picture.cut = *cut;
            return picture;
        };
        made.write = [=](const std::string& file) {
            write_numbers(file, *maps, is_mean ? maps->mean : maps->deviation);
        };
        made.drawing = std::move(field.drawing);
        return made;
    });
}

}  // namespace vog::cli
