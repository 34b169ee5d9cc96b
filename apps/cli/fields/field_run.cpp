// field_run.cpp: maps of a field from inputs to files, and their report.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "fields/divided_models.h"
#include "fields/gpu_drawing.h"
#include "fields/volume_fields.h"
#include "shared/render_run.h"
#include "values/value_maps.h"
#include "vog/error.h"
#include "vog/field_maps.h"
#include "vog/picture.h"

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
    if (drawing.kind == FileKind::volume && on_gpu(drawing.renderer) && ranks.divided())
        throw Error(fmt::format("{}: {} draws no parts of volumes, expected reference", show,
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
    const bool cuts = drawing.renderer == Renderer::splat || given.pixel_error;
    const auto hierarchy = std::make_shared<Hierarchy>();
    const auto model = std::make_shared<Gaussians>(
        load_model_part(arguments, drawing, ranks, cuts ? hierarchy.get() : nullptr));
    // A model without a hierarchy gets one where --pixel-error is given.
    if (hierarchy->empty() && given.pixel_error && model->size() > 0)
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
    const Clipping clip = clip_of(given, *model);
    DrawMaps draw;
    if (on_gpu(drawing.renderer) && !hierarchy->empty()) {
        if (!ranks.divided()) made.cut = std::make_shared<CutReport>();
        draw = [cut = gpu_cut(arguments, drawing, model, hierarchy), clip, report = made.cut](
                   const FieldChoice& shown, const Camera& camera, Size size, const Progress&) {
            return cut(shown, camera, size, clip, report.get());
        };
    } else if (on_gpu(drawing.renderer)) {
        draw = [clip, pictures = gpu_pictures(arguments, drawing, model)](
                   const FieldChoice& shown, const Camera& camera, Size size, const Progress&) {
            return pictures->fields(shown, camera, size.width, size.height, clip);
        };
    } else if (drawing.renderer == Renderer::trace) {
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

/// The choice among the parts of a field.
/// text  of --field
FieldChoice choice_of(const std::string& text, const std::string& name, bool is_vector) {
    Fields names;
    if (is_vector)
        names.vector.emplace_back().name = name;
    else
        names.scalar.emplace_back().name = name;
    return field_choice(name + text.substr(text.size() - part_length(text)), names);
}

/// Options of the reference by those of the command.
struct FieldReference {
    ReferenceOptions options;
    VoxelGridOptions voxels;
};
FieldReference reference_of(const DrawingArguments& given) {
    FieldReference made;
    made.options.samples = given.samples;
    made.options.clip = clip_of(given);
    if (given.interpolation == "linear") made.voxels.interpolation = Interpolation::linear;
    made.voxels.step_voxels = given.step_voxels;
    return made;
}

FieldDrawing load_volume_field(const RenderArguments& arguments, Drawing drawing) {
    const DrawingArguments& given = arguments.drawing;
    const auto data = std::make_shared<VolumesWithField>(load_volumes(given.inputs, given.volume));
    std::vector<Volume>& volumes = data->set.volumes;
    for (const Volume& volume : volumes) drawing.active_voxels += active_voxels(volume);
    drawing.subject = subject_of(volumes);
    const std::string& text = arguments.quantity.field;
    const std::string grid = text.substr(0, text.size() - part_length(text));
    drawing.notes = data->set.notes;
    data->field = std::move(
        read_volume_fields({{grid}, given.volume.grid, given.inputs}, volumes, drawing.notes)
            .front());
    print_notes(drawing.notes);
    const VoxelField& field = data->field.front();
    const FieldChoice choice = choice_of(text, field.name, field.is_vector());
    FieldDrawing made;
    made.unit = field.unit;
    made.label = field_label(choice);
    set_primitives_text(drawing, data->set.is_mesh() ? volumes.size() : 0);
    if (on_gpu(drawing.renderer)) {
        const auto on_it =
            data->set.is_mesh()
                ? gpu_volumes(drawing, static_cast<const Levels&>(data->set), data->field)
                : gpu_volumes(drawing, data->set.volumes, data->field);
        made.draw = [=, options = reference_of(given).options](const Camera& camera, Size size,
                                                               const Progress&) {
            return on_it->fields(choice.part, camera, size.width, size.height, options);
        };
        made.drawing = std::move(drawing);
        return made;
    }
    made.draw = [=, options = reference_of(given).options, voxels = reference_of(given).voxels](
                    const Camera& camera, Size size, const Progress& progress) mutable {
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

/// This rank's part of volumes with their field.
struct DividedWithField {
    std::vector<Volume> volumes;  ///< no mesh: with field
    std::vector<VoxelField> field;
    std::vector<Levels> levels;  ///< a mesh: its fields
    std::vector<std::vector<VoxelField>> fields;
};

/// Any field with values at the nodes of a volume without density: one within the range of another field, which keeps
/// its digits in units of the range of both.
VoxelField any_field(const Volume& volume, const Volume& of_other, const VoxelField& other) {
    VoxelField field;
    field.component.resize(other.component.size());
    for (std::size_t c = 0; c < field.component.size(); ++c) {
        const VoxelValues& from = other.component[c];
        VoxelValues& values = field.component[c];
        float value = static_cast<float>(other.lower);
        if (!from.tile.empty()) {
            value = from.tile.front();
        } else if (!from.leaf.empty()) {
            int n = 0;
            while (n + 1 < kLeafVoxels && !of_other.leaves.front().active(n)) ++n;
            value = from.leaf.front()[static_cast<std::size_t>(n)];
        }
        values.leaf.resize(volume.leaves.size());
        for (auto& leaf : values.leaf) leaf.fill(value);
        values.tile.assign(volume.tiles.size(), value);
    }
    return field;
}

/// Levels of this rank's part, each with the field of its last volume.
/// volumes  the last volume of each
void take_levels(std::vector<VolumeSet> sets, std::vector<Volume> volumes,
                 std::vector<VoxelField> field, DividedWithField& data) {
    for (std::size_t n = 0; n < sets.size(); ++n) {
        Levels& levels = data.levels.emplace_back(std::move(sets[n]));
        levels.volumes.back() = std::move(volumes[n]);
        std::vector<VoxelField>& fields = data.fields.emplace_back();
        for (std::size_t finer = 0; finer + 1 < levels.volumes.size(); ++finer)
            fields.push_back(any_field(levels.volumes[finer], levels.volumes.back(), field[n]));
        fields.push_back(std::move(field[n]));
    }
}

/// As load_volume_field, of this rank's part; maps are joint on every rank.
FieldDrawing load_divided_field(const RenderArguments& arguments, Drawing drawing,
                                const RenderRanks& ranks) {
    const DrawingArguments& given = arguments.drawing;
    DividedVolumes part = ranks.load_volumes(given, given.volume, false);
    if (part.failure) std::rethrow_exception(part.failure);
    if (part.is_mesh && given.interpolation == "linear")
        throw CLI::ValidationError(
            "--interpolation linear: at the edge of a part, levels of a mesh need values that "
            "other ranks hold; expected --interpolation constant, or one process (vog render)");
    std::vector<Volume> volumes;
    for (VolumeSet& set : part.sets) {
        if (part.is_mesh)
            volumes.push_back(std::move(set.volumes.back()));
        else
            std::ranges::move(set.volumes, std::back_inserter(volumes));
    }
    std::erase_if(volumes, [](const Volume& volume) { return volume.empty(); });
    double voxels = 0;
    for (const Volume& volume : volumes) voxels += static_cast<double>(active_voxels(volume));
    ranks.collective.sum(voxels);
    drawing.active_voxels = static_cast<std::uint64_t>(voxels);
    drawing.subject = part.subject;
    drawing.notes = part.notes;
    const std::string& text = arguments.quantity.field;
    const std::string grid = text.substr(0, text.size() - part_length(text));
    std::vector<FieldCoverage> coverage(1);
    std::vector<VoxelField> field;
    std::vector<std::string> notes;
    if (!volumes.empty())
        field = std::move(
            read_volume_fields({{grid}, given.volume.grid, given.inputs}, volumes, notes, &coverage)
                .front());
    notes.clear();
    const SharedField shared = shared_field(volumes, field, coverage.front(), ranks, notes);
    if (ranks.is_root) print_notes(notes);
    drawing.notes.insert(drawing.notes.end(), notes.begin(), notes.end());
    const FieldChoice choice = choice_of(text, shared.name, shared.is_vector);
    FieldDrawing made;
    made.unit = shared.unit;
    made.label = field_label(choice);
    set_primitives_text(drawing, part.is_mesh ? part.volumes : 0);
    const auto data = std::make_shared<DividedWithField>();
    if (part.is_mesh)
        take_levels(std::move(part.sets), std::move(volumes), std::move(field), *data);
    else
        data->volumes = std::move(volumes), data->field = std::move(field);
    FieldReference reference = reference_of(given);
    reference.options.collective = &ranks.collective;
    made.draw = [=, mesh = part.is_mesh](const Camera& camera, Size size,
                                         const Progress& progress) mutable {
        const auto& [options, grids] = reference;
        reference.options.progress = progress;
        const int width = size.width, height = size.height;
        return mesh ? render_field_reference(data->levels, data->fields, choice.part, camera, width,
                                             height, options, grids)
                    : render_field_reference(data->volumes, data->field, choice.part, camera, width,
                                             height, options, grids);
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
        FieldDrawing field =
            drawing.kind == FileKind::model ? load_model(arguments, std::move(drawing), ranks)
            : ranks.divided() ? load_divided_field(arguments, std::move(drawing), ranks)
                              : load_volume_field(arguments, std::move(drawing));
        const bool is_mean = arguments.quantity.show == "mean";
        const auto maps = std::make_shared<FieldMaps>();
        const auto factor = static_cast<float>(units_factor(field.unit, arguments.quantity.units));
        MapDrawing made;
        made.draw = [=, draw = field.draw](const Camera& camera, Size size,
                                           const Progress& progress) {
            *maps = draw(camera, size, progress);
            for (std::vector<float>* values : {&maps->mean, &maps->deviation})
                for (float& value : *values) value *= factor;
        };
        made.picture = [=, &arguments, label = field.label, unit = field.unit,
                        cut = field.cut](const QuantityArguments& quantity) {
            require_finite(*maps, arguments.drawing.inputs.front());
            ColoredMap colored = colored_map(*maps, quantity.show, quantity.fit(),
                                             fixed_scale(quantity), quantity.least_column);
            MapPicture picture{quantity_label(quantity.show, label),
                               unit,
                               std::move(colored.shown),
                               is_mean ? maps->mean : maps->deviation,
                               DepthImage(maps->width, maps->height),
                               colored.scale};
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
