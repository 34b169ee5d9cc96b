// value_inputs.cpp: the field of --field of models and volumes.
#include "values/value_inputs.h"

#include <fmt/core.h>

#include <algorithm>

#include "fields/divided_models.h"
#include "fields/gpu_drawing.h"
#include "fields/volume_fields.h"
#include "vog/error.h"
#include "vog/field_maps.h"
#include "vog/picture.h"

namespace vog::cli {

namespace {

/// throws vog::Error for inputs and renderers that do not draw by value
void check_by_value(const RenderArguments& arguments, const Drawing& drawing,
                    const RenderRanks& ranks) {
    const std::string show = "--show " + arguments.quantity.show;
    require_addable(arguments, drawing, ranks);
    const std::string& input = arguments.drawing.inputs.front();
    if (drawing.kind == FileKind::points)
        throw Error(fmt::format("{}: holds particles, {} is of models and volumes", input, show));
    if (on_gpu(drawing.renderer) && ranks.divided())
        throw Error(fmt::format("{}: {} draws no parts of a {} by value, expected {}", show,
                                info_of(drawing.renderer).name,
                                drawing.kind == FileKind::volume ? "volume" : "model",
                                drawing.kind == FileKind::volume ? "reference" : "splat"));
}

/// Sums of the data over all ranks.
void add_ranks(ValueData& data, const Box& box, const RenderRanks& ranks) {
    double most[2] = {data.is_measure ? 1.0 : 0.0, data.counts.empty() ? 0.0 : 1.0};
    ranks.collective.sum(data.mass);
    ranks.collective.max(most);
    data.is_measure = most[0] > 0;
    data.box = box;
    if (!(most[1] > 0)) return;
    ranks.collective.sum(data.counts.weights());
    data.spread = data.counts.spread();
}

ValueInputs load_model_values(const RenderArguments& arguments, Drawing drawing,
                              const RenderRanks& ranks) {
    const std::string& input = arguments.drawing.inputs.front();
    const auto model = std::make_shared<Gaussians>(load_model_part(arguments, drawing, ranks));
    const ScalarField& field =
        scalar_field_of(model->fields, arguments.quantity.field, input, arguments.quantity.show);
    ValueData data = value_data(*model, field);
    add_ranks(data, drawing.subject.box, ranks);
    return {std::move(drawing), field.name, field.unit, std::move(data), model, {}};
}

/// Part of a text that names one number of a vector: ".x" of "velocity.x"; empty: none.
std::string part_of(const std::string& text) {
    for (const char* part : {".x", ".y", ".z", ".magnitude"})
        if (text.ends_with(part)) return part;
    return {};
}

/// Reads the field of --field: "temperature", or "velocity.x" of a vector field.
/// coverage  of a part of volumes, as read_volume_fields has it; null: whole volumes
std::vector<VoxelField> read_field_of(const RenderArguments& arguments,
                                      std::vector<Volume>& volumes, std::vector<std::string>& notes,
                                      std::vector<FieldCoverage>* coverage = nullptr) {
    const std::string& text = arguments.quantity.field;
    if (text.empty()) return own_values(volumes);
    const std::string part = part_of(text), grid = text.substr(0, text.size() - part.size());
    std::vector<VoxelField> fields = std::move(
        read_volume_fields({{grid}, arguments.drawing.volume.grid, arguments.drawing.inputs},
                           volumes, notes, coverage)
            .front());
    for (VoxelField& field : fields) {
        const std::string name = printable(field.name), &show = arguments.quantity.show;
        const std::string& input = arguments.drawing.inputs.front();
        if (field.is_vector() && part.empty())
            throw Error(fmt::format(
                "{0}: field '{1}' is a vector, --show {2} draws one number: --field {1}.x, {1}.y, "
                "{1}.z or {1}.magnitude",
                input, name, show));
        if (!field.is_vector() && !part.empty())
            throw Error(fmt::format("{}: field '{}' is scalar and has no {}, expected --field {}",
                                    input, name, part, name));
        if (part.empty()) continue;
        const auto place = static_cast<std::size_t>(&field - fields.data());
        field = component_of(std::move(field), part.substr(1), volumes[place]);
    }
    return fields;
}

bool may_be_signed(const VolumeInputOptions& options) {
    return !options.values.clip_negative && !options.level_set_to_fog;
}
std::string signed_note(const std::string& input, double lower, double upper) {
    return fmt::format(
        "{}: values from {:.6g} to {:.6g}: no density, every active voxel counts alike", input,
        lower, upper);
}

/// A volume with values below 0, which are no densities: every active voxel counts as 1, and the values are a field.
/// returns  nothing for other volumes
std::optional<std::pair<LoadedVolumes, VoxelField>> load_signed(const RenderArguments& arguments) {
    const DrawingArguments& given = arguments.drawing;
    if (!may_be_signed(given.volume)) return std::nullopt;
    VolumeInputOptions options = given.volume;
    options.ones = true;
    LoadedVolumes set = load_volumes(given.inputs, options);
    Volume& volume = set.volumes.front();
    const std::string& text = arguments.quantity.field;
    if (set.volumes.size() > 1 || set.is_mesh() || !(text.empty() || text == volume.name))
        return std::nullopt;
    VoxelField field = read_field({.file = volume.source, .grid = volume.name}, volume);
    if (!(field.lower < 0) || field.is_vector()) return std::nullopt;
    set.notes.push_back(signed_note(given.inputs.front(), field.lower, field.upper));
    return std::pair{std::move(set), std::move(field)};
}

ValueInputs load_volume_values(const RenderArguments& arguments, Drawing drawing) {
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
    const auto data = std::make_shared<PartsWithField>();
    if (set.is_mesh()) {
        Composite mesh = composite(set);
        drawing.subject = subject_of(mesh.box, mesh.content);
        data->volumes = std::move(mesh.parts);
    } else {
        data->volumes = std::move(set.volumes);
        drawing.subject = subject_of(data->volumes);
    }
    drawing.notes = set.notes;
    if (signed_field)
        data->field.push_back(std::move(*signed_field));
    else
        data->field = read_field_of(arguments, data->volumes, drawing.notes);
    print_notes(drawing.notes);
    ValueInputs made;
    made.unit = data->field.front().unit;
    made.label = data->field.front().name;
    made.data = value_data(data->volumes, data->field, drawing.subject.box);
    for (const Volume& volume : data->volumes) drawing.active_voxels += active_voxels(volume);
    set_primitives_text(drawing, set.is_mesh() ? data->volumes.size() : 0);
    made.volumes = data;
    made.drawing = std::move(drawing);
    return made;
}

/// Fields at this rank's volumes and those beside them.
/// read(volumes, coverage)  reads it at some volumes, none of them empty
template <class Read>
void read_divided_field(PartsWithField& data, FieldCoverage& coverage, const Read& read) {
    std::vector<FieldCoverage> counted(1);
    if (!data.volumes.empty()) data.field = read(data.volumes, counted);
    coverage = counted.front();
    data.beside_field.resize(data.beside.size());
    for (std::size_t n = 0; n < data.beside.size(); ++n) {
        data.beside_field[n].component.resize(1);
        if (data.beside[n].empty()) continue;
        std::vector<Volume> one;
        one.push_back(std::move(data.beside[n]));
        data.beside_field[n] = std::move(read(one, counted).front());
        data.beside[n] = std::move(one.front());
    }
}

/// As load_signed, of parts.
/// returns  the range of the values
std::optional<SharedField> load_divided_signed(const RenderArguments& arguments, bool beside,
                                               const RenderRanks& ranks, PartsWithField& data,
                                               DividedVolumes& part) {
    const DrawingArguments& given = arguments.drawing;
    if (!may_be_signed(given.volume)) return std::nullopt;
    VolumeInputOptions options = given.volume;
    options.ones = true;
    part = ranks.load_volumes(given, options, beside);
    if (part.failure) std::rethrow_exception(part.failure);
    if (part.volumes > 1 || part.is_mesh) return std::nullopt;
    data = visible_volumes(part);
    const std::string& text = arguments.quantity.field;
    double other = 0;
    for (const Volume& volume : data.volumes) other = !(text.empty() || text == volume.name);
    ranks.collective.max(std::span(&other, 1));
    if (other > 0) return std::nullopt;
    FieldCoverage coverage;
    read_divided_field(
        data, coverage, [](std::vector<Volume>& volumes, std::vector<FieldCoverage>& counts) {
            std::vector<VoxelField> fields;
            for (Volume& volume : volumes)
                fields.push_back(read_field({.file = volume.source, .grid = volume.name}, volume,
                                            {}, nullptr, &counts.front()));
            return fields;
        });
    const SharedField field = shared_field(data.volumes, data.field, coverage, ranks, part.notes);
    if (!(field.lower < 0) || field.is_vector) return std::nullopt;
    const std::string text_of_range = signed_note(given.inputs.front(), field.lower, field.upper);
    if (ranks.is_root) print_notes({text_of_range});
    part.notes.push_back(text_of_range);
    return field;
}

/// As load_volume_values, of this rank's part; the range is that of all ranks.
ValueInputs load_divided_values(const RenderArguments& arguments, Drawing drawing,
                                const RenderRanks& ranks) {
    const DrawingArguments& given = arguments.drawing;
    const bool beside = arguments.quantity.volume() && look_of(arguments.value).light;
    DividedVolumes part = ranks.load_volumes(given, given.volume, beside);
    const auto data = std::make_shared<PartsWithField>();
    std::optional<SharedField> field;
    if (const std::exception_ptr failure = part.failure) {
        field = load_divided_signed(arguments, beside, ranks, *data, part);
        if (!field) std::rethrow_exception(failure);
    } else {
        *data = visible_volumes(part);
        FieldCoverage coverage;
        std::vector<std::string> notes;
        read_divided_field(*data, coverage,
                           [&](std::vector<Volume>& volumes, std::vector<FieldCoverage>& counts) {
                               return read_field_of(arguments, volumes, notes, &counts);
                           });
        notes.clear();
        field = shared_field(data->volumes, data->field, coverage, ranks, notes);
        if (ranks.is_root) print_notes(notes);
        part.notes.insert(part.notes.end(), notes.begin(), notes.end());
    }
    // Of parts of a mesh: some may overlap where its lattices do not fit.
    double figures[1] = {data->overlap ? 1.0 : 0.0};
    ranks.collective.max(figures);
    data->overlap = figures[0] > 0;
    double voxels = 0;
    for (const Volume& volume : data->volumes) voxels += static_cast<double>(active_voxels(volume));
    ranks.collective.sum(voxels);
    drawing.active_voxels = static_cast<std::uint64_t>(voxels);
    drawing.subject = part.subject;
    drawing.notes = part.notes;
    set_primitives_text(drawing, part.is_mesh ? part.volumes : 0);
    ValueData sums = value_data(data->volumes, data->field, part.subject.box);
    add_ranks(sums, part.subject.box, ranks);
    sums.lower = field->lower, sums.upper = field->upper;
    return {std::move(drawing), field->name, field->unit, std::move(sums), {}, data};
}

}  // namespace

const ScalarField& scalar_field_of(const Fields& fields, const std::string& name,
                                   const std::string& input, const std::string& show) {
    if (const ScalarField* found = scalar_to_show(fields, name)) return *found;
    const std::string whole = name.substr(0, name.size() - part_of(name).size());
    const auto error = [&](const std::string& what, const std::string& remedy) {
        return Error(fmt::format("{}: {}; {}{}", input, what, remedy,
                                 fields.scalar.empty()
                                     ? ""
                                     : fmt::format(" (scalar fields: {})", scalar_names(fields))));
    };
    if (const VectorField* vector = fields.find_vector(whole))
        throw error(
            fmt::format("'{}' is a vector field, and --show {} draws scalar fields of a model",
                        printable(vector->name), show),
            fmt::format("--show mean --field {} draws it, or --show {} of the volume",
                        printable(name), show));
    if (fields.scalar.empty())
        throw error(fmt::format("--show {} needs a scalar field, and the model has none", show),
                    "vog convert VOLUME -o model.ply makes a model with one");
    throw error(fmt::format("--show {}: no scalar field{}", show,
                            name.empty() ? " chosen" : fmt::format(" '{}'", printable(name))),
                "expected --field NAME");
}

ValueInputs load_values(const RenderArguments& arguments, const CLI::App& command,
                        const RenderRanks& ranks) {
    Drawing drawing = begin_drawing(arguments.drawing, command);
    check_by_value(arguments, drawing, ranks);
    if (drawing.kind == FileKind::model)
        return load_model_values(arguments, std::move(drawing), ranks);
    return ranks.divided() ? load_divided_values(arguments, std::move(drawing), ranks)
                           : load_volume_values(arguments, std::move(drawing));
}

}  // namespace vog::cli
