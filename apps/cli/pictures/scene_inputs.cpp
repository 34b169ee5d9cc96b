// scene_inputs.cpp: scenes of models, particles and whole volumes.
#include "pictures/scene_inputs.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "conversion/volume_fields.h"
#include "files/sequence.h"
#include "terminal/terminal.h"
#include "terminal/usage_error.h"
#include "vog/convert_points.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::cli {

namespace {

/// Length of the part in the text of a field: ".x" of "velocity.x".
std::size_t part_length(const std::string& text) {
    for (const std::string_view part : {".x", ".y", ".z", ".magnitude"})
        if (text.ends_with(part)) return part.size();
    return 0;
}

/// "1 triangle", "2,000 voxels".
std::string counted(std::uint64_t count, const char* noun) {
    return fmt::format("{} {}{}", count_text(count), noun, count == 1 ? "" : "s");
}

/// Sets the range of a field to that over all ranks.
template <class Field>
void share_range(Field& field, const RenderRanks& ranks) {
    double ends[2] = {-field.lower, field.upper};
    ranks.collective.max(ends);
    field.lower = -ends[0], field.upper = ends[1];
}

/// What views of the inputs of a scene frame.
Subject subject_of_inputs(const DrawingArguments& arguments) {
    Subject subject;
    for (const std::string& input : arguments.inputs)
        subject.include(subject_of(input, arguments.volume, arguments.points));
    return subject;
}

void load_gaussians(const DrawingArguments& arguments, const PictureRequest& request,
                    const RenderRanks& ranks, const ViewOfSites& view_of, SceneInputs& inputs) {
    const bool points = inputs.kind == FileKind::points;
    std::optional<SiteView> view;
    if (view_of && all_sites(arguments.inputs)) view = view_of(subject_of_inputs(arguments));
    // The chunks of a site that is read for a view are the cut.
    const bool builds_hierarchy = request.options.pixel_error && !view;
    const bool cuts = !is_by_value(request.show) && !points && !ranks.divided() &&
                      (*request.renderer == Renderer::splat || builds_hierarchy);
    auto hierarchy = std::make_shared<Hierarchy>();
    const auto read = [&] {
        if (points && ranks.divided()) return ranks.load_points(arguments, inputs.notes);
        // Particles become one Gaussian each, without a file between.
        if (points)
            return convert_points(
                load_points(arguments.inputs, arguments.points, arguments.volume, inputs.notes),
                point_options(arguments.points));
        if (ranks.divided()) return ranks.load_models(arguments.inputs, arguments.volume.values);
        return load_models(arguments.inputs, cuts ? hierarchy.get() : nullptr, view,
                           arguments.volume.values);
    };
    const auto model = std::make_shared<Gaussians>(read());
    if (view) inputs.site = *view->report;
    double count = static_cast<double>(model->size());
    if (ranks.divided()) {
        ranks.collective.sum(count);
        if (shows_field(request)) {
            for (ScalarField& field : model->fields.scalar) share_range(field, ranks);
            for (VectorField& field : model->fields.vector) share_range(field, ranks);
        }
    } else {
        print_notes(inputs.notes);
    }
    if (is_by_value(request.show))
        inputs.field =
            scalar_field_of(model->fields, request.field, arguments.inputs.front(), request.show)
                .name;
    inputs.scene.subject = subject_of(*model, &ranks.collective);
    inputs.gaussians = static_cast<std::uint64_t>(count);
    inputs.set_primitives_text(0);
    // A model without a hierarchy gets one where --pixel-error is given, which sorts it.
    if (hierarchy->empty() && builds_hierarchy && model->size() > 0 && !is_by_value(request.show))
        *hierarchy = build_hierarchy(*model);
    if (points) {
        const std::string& value = arguments.points.value;
        inputs.scene.column = (value.empty() || value == "count" ? "number" : value) + " per area";
    }
    inputs.scene.sources.push_back(ModelSource{model, hierarchy});
}

/// A volume with values below 0, which are no densities: every active voxel counts as 1, and the values are a field.
/// returns  nothing for other volumes
std::optional<std::pair<LoadedVolumes, VoxelField>> load_signed(const DrawingArguments& arguments,
                                                                const std::string& text) {
    if (!may_be_signed(arguments.volume)) return std::nullopt;
    VolumeInputOptions options = arguments.volume;
    options.ones = true;
    LoadedVolumes set = load_volumes(arguments.inputs, options);
    Volume& volume = set.volumes.front();
    if (set.volumes.size() > 1 || set.is_mesh() || !(text.empty() || text == volume.name))
        return std::nullopt;
    VoxelField field = read_field({.file = volume.source, .grid = volume.name}, volume);
    if (!(field.lower < 0) || field.is_vector()) return std::nullopt;
    set.notes.push_back(signed_note(arguments.inputs.front(), field.lower, field.upper));
    return std::pair{std::move(set), std::move(field)};
}

void load_voxels(const DrawingArguments& arguments, const PictureRequest& request,
                 SceneInputs& inputs) {
    const bool by_value = is_by_value(request.show);
    std::optional<VoxelField> signed_field;
    LoadedVolumes set = [&] {
        try {
            return load_volumes(arguments.inputs, arguments.volume);
        } catch (const Error&) {
            const bool signed_values = by_value || request.show == Show::slice;
            auto loaded = signed_values ? load_signed(arguments, request.field) : std::nullopt;
            if (!loaded) throw;
            signed_field = std::move(loaded->second);
            return std::move(loaded->first);
        }
    }();
    const bool mesh = set.is_mesh();
    if (mesh && by_value) {
        Composite parts = composite(set);
        inputs.scene.subject = subject_of(parts.box, parts.content);
        set.volumes = std::move(parts.parts);
        set.masks.clear(), set.overlap = Overlap::add;
    } else {
        inputs.scene.subject = subject_of(set.volumes);
    }
    inputs.notes = set.notes;
    VoxelSource source;
    if (shows_field(request) || signed_field) {
        SampledField field;
        if (signed_field)
            field.values.push_back(std::move(*signed_field));
        else
            field.values = read_shown_field(arguments, request, set.volumes, inputs.notes);
        const VoxelField& first = field.values.front();
        field.name = first.name, field.unit = first.unit, field.is_vector = first.is_vector();
        inputs.field = field.name;
        source.fields.push_back(std::move(field));
    }
    print_notes(inputs.notes);
    for (const Volume& volume : set.volumes) inputs.active_voxels += active_voxels(volume);
    inputs.set_primitives_text(mesh ? set.volumes.size() : 0);
    source.volumes = std::make_shared<VolumeSet>(std::move(set));
    inputs.scene.sources.push_back(std::move(source));
}

/// throws vog::Error for particles with a quantity of fields
void require_field_data(const DrawingArguments& arguments, const PictureRequest& request,
                        FileKind kind) {
    if (kind == FileKind::points && shows_field(request))
        throw Error(fmt::format(
            "{0}: holds particles; --show {1} needs a model of them with a field (vog convert {0} "
            "--field NAME -o model.ply) or a volume of their density (vog voxelize of a model)",
            arguments.inputs.front(), word_of(request.show)));
}

}  // namespace

bool may_be_signed(const VolumeInputOptions& options) {
    return !options.values.clip_negative && !options.level_set_to_fog;
}

std::string signed_note(const std::string& input, double lower, double upper) {
    return fmt::format(
        "{}: values from {:.6g} to {:.6g} are not densities: every active voxel has the same "
        "weight",
        input, lower, upper);
}

void SceneInputs::set_primitives_text(std::size_t levels) {
    if (kind != FileKind::volume) {
        primitives_text = counted(gaussians, "Gaussian");
        return;
    }
    primitives_text = counted(active_voxels, "voxel");
    if (levels) primitives_text += fmt::format(" in {} levels", levels);
}

std::vector<VoxelField> read_shown_field(const DrawingArguments& arguments,
                                         const PictureRequest& request,
                                         std::vector<Volume>& volumes,
                                         std::vector<std::string>& notes,
                                         std::vector<FieldCoverage>* coverage) {
    const std::string& text = request.field;
    if (text.empty()) return own_values(volumes);
    const std::string part = text.substr(text.size() - part_length(text)),
                      grid = text.substr(0, text.size() - part.size());
    std::vector<VoxelField> fields =
        std::move(read_volume_fields({{grid}, arguments.volume.grid, arguments.inputs}, volumes,
                                     notes, coverage)
                      .front());
    if (!is_by_value(request.show)) return fields;
    for (VoxelField& field : fields) {
        const std::string name = printable(field.name);
        const std::string& input = arguments.inputs.front();
        if (field.is_vector() && part.empty())
            throw Error(
                fmt::format("{0}: field '{1}' is a vector, but --show {2} draws one number; use "
                            "--field {1}.x, {1}.y, {1}.z or {1}.magnitude",
                            input, name, word_of(request.show)));
        if (!field.is_vector() && !part.empty())
            throw Error(fmt::format("{}: field '{}' is scalar and has no {}; use --field {}", input,
                                    name, part, name));
        if (part.empty()) continue;
        const auto place = static_cast<std::size_t>(&field - fields.data());
        field = component_of(std::move(field), part.substr(1), volumes[place]);
    }
    return fields;
}

const ScalarField& scalar_field_of(const Fields& fields, const std::string& name,
                                   const std::string& input, Show show) {
    if (const ScalarField* found = scalar_to_show(fields, name)) return *found;
    const std::string whole = name.substr(0, name.size() - part_length(name));
    const char* const word = word_of(show);
    const auto error = [&](const std::string& what, const std::string& remedy) {
        return Error(fmt::format("{}: {}; {}{}", input, what, remedy,
                                 fields.scalar.empty()
                                     ? ""
                                     : fmt::format(" (scalar fields: {})", scalar_names(fields))));
    };
    if (const VectorField* vector = fields.find_vector(whole))
        throw error(
            fmt::format("'{}' is a vector field, and --show {} draws scalar fields of a model",
                        printable(vector->name), word),
            fmt::format("--show mean --field {} draws it, or --show {} of the volume",
                        printable(name), word));
    if (fields.scalar.empty())
        throw error(fmt::format("--show {} needs a scalar field, and the model has none", word),
                    "vog convert VOLUME -o model.ply makes a model with one, of particles with "
                    "--field NAME");
    throw error(fmt::format("--show {}: no scalar field{}", word,
                            name.empty() ? " chosen" : fmt::format(" '{}'", printable(name))),
                "expected --field NAME");
}

namespace {

/// Reads the data of a layer, whose field the request then names.
SceneInputs load_layer(DrawingArguments own, PictureRequest& request, std::size_t n,
                       const RenderRanks& ranks, const ViewOfSites& view) {
    Layer& layer = request.layers[n];
    const std::string& input = own.inputs.front();
    SceneInputs inputs;
    if (own.inputs.size() == 1 && is_surface_file(input)) {
        inputs.scene =
            scene_of(std::make_shared<const Surface>(read_surface(input, &inputs.notes)));
        if (ranks.is_root) print_notes(inputs.notes);
        inputs.scene.name = input;
        inputs.primitives_text = counted(inputs.scene.surface().triangle.size(), "triangle");
        return inputs;
    }
    if (!layer.grid.empty()) own.volume.grid = layer.grid;
    const FileKind kind = common_kind(own.inputs, own.volume.grid);
    if (!layer.grid.empty() && kind != FileKind::volume)
        throw UsageError(fmt::format("--layer grid={}: {} holds no grids, expected a volume",
                                     layer.grid, input));
    PictureRequest one = request;
    one.layers.clear();
    one.field = layer.field;
    one.renderer = renderer_of({}, own, kind);
    inputs = load_scene(own, one, ranks, view);
    if (!layer.field.empty() && !inputs.field.empty()) layer.field = inputs.field;
    return inputs;
}

}  // namespace

SceneInputs load_layers(const DrawingArguments& arguments, PictureRequest& request,
                        const RenderRanks& ranks, const ViewOfSites& view) {
    if (ranks.divided()) require_addable_layers(arguments, request);
    SceneInputs all;
    std::vector<Scene> scenes(request.layers.size());
    std::vector<std::string> texts(scenes.size());
    const auto add = [&](std::size_t n, DrawingArguments own, const ViewOfSites& view_of_all) {
        SceneInputs inputs = load_layer(std::move(own), request, n, ranks, view_of_all);
        scenes[n] = std::move(inputs.scene), texts[n] = std::move(inputs.primitives_text);
        all.gaussians += inputs.gaussians, all.active_voxels += inputs.active_voxels;
        all.notes.insert(all.notes.end(), inputs.notes.begin(), inputs.notes.end());
        if (!inputs.site) return;
        if (!all.site) all.site.emplace();
        all.site->chunks += inputs.site->chunks, all.site->bytes_read += inputs.site->bytes_read;
    };
    // Sites last: their view frames all layers.
    std::vector<std::pair<std::size_t, DrawingArguments>> sites;
    Subject subject;
    for (std::size_t n = 0; n < scenes.size(); ++n) {
        if (!request.layers[n].visible) continue;
        DrawingArguments own = arguments;
        own.inputs = expanded({arguments.layer_inputs[request.layers[n].input]});
        if (const auto models = models_of_one_site(own.inputs);
            !models.empty() && n > 0 && ranks.is_root)
            note_first_model(own.inputs.front(), models);
        if (view && all_sites(own.inputs)) {
            subject.include(subject_of_inputs(own));
            sites.emplace_back(n, std::move(own));
        } else {
            add(n, std::move(own), {});
            subject.include(scenes[n].subject);
        }
    }
    const auto view_of_all = [&](const Subject&) { return view(subject); };
    for (auto& [n, own] : sites) add(n, std::move(own), view_of_all);
    for (const std::string& text : texts)
        if (!text.empty())
            all.primitives_text += (all.primitives_text.empty() ? "" : " and ") + text;
    all.scene = scene_of_layers(std::move(scenes));
    return all;
}

SceneInputs load_scene(const DrawingArguments& arguments, const PictureRequest& request,
                       const RenderRanks& ranks, const ViewOfSites& view) {
    SceneInputs inputs;
    const std::string& input = arguments.inputs.front();
    inputs.kind = common_kind(arguments.inputs, arguments.volume.grid);
    require_field_data(arguments, request, inputs.kind);
    inputs.scene.name = input;
    if (ranks.divided()) {
        require_addable(request, inputs.kind);
        inputs.scene.collective = &ranks.collective;
    }
    if (inputs.kind != FileKind::volume) {
        load_gaussians(arguments, request, ranks, view, inputs);
    } else {
        if (ranks.divided())
            load_divided(arguments, request, ranks, inputs);
        else
            load_voxels(arguments, request, inputs);
        if (!inputs.field.empty()) {
            // By value a part is a field of its own.
            const std::size_t part = is_by_value(request.show) ? 0 : part_length(request.field);
            inputs.field += request.field.substr(request.field.size() - part);
        }
    }
    return inputs;
}

}  // namespace vog::cli
