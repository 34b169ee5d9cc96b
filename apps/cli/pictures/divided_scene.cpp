// divided_scene.cpp: scenes of volumes whose parts lie on several ranks of vog-mpi.
#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <iterator>

#include "conversion/volume_fields.h"
#include "files/sequence.h"
#include "pictures/scene_inputs.h"
#include "vog/error.h"
#include "vog/surface.h"

namespace vog::cli {

namespace {

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

double count_voxels(const std::vector<Volume>& volumes, const RenderRanks& ranks) {
    double voxels = 0;
    for (const Volume& volume : volumes) voxels += static_cast<double>(active_voxels(volume));
    ranks.collective.sum(voxels);
    return voxels;
}

/// Adds a source of volumes with the field that all ranks know.
void add_source(VolumeSet set, std::vector<VoxelField> values, const SharedField& field,
                SceneInputs& inputs) {
    VoxelSource source;
    source.volumes = std::make_shared<VolumeSet>(std::move(set));
    source.fields.push_back({field.name, field.unit, field.is_vector, std::move(values)});
    inputs.scene.sources.push_back(std::move(source));
}

void add_notes(const std::vector<std::string>& notes, const RenderRanks& ranks,
               SceneInputs& inputs) {
    if (ranks.is_root) print_notes(notes);
    inputs.notes.insert(inputs.notes.end(), notes.begin(), notes.end());
}

void load_parts(DividedVolumes part, SceneInputs& inputs) {
    inputs.active_voxels = part.active_voxels;
    for (VolumeSet& set : part.sets) {
        if (set.volumes.empty()) continue;
        VoxelSource source;
        source.volumes = std::make_shared<VolumeSet>(std::move(set));
        inputs.scene.sources.push_back(std::move(source));
    }
    if (inputs.scene.sources.empty())
        inputs.scene.sources.push_back(VoxelSource{std::make_shared<VolumeSet>(), {}});
}

/// Parts with the field of a map: of a mesh a source for each level, with any values in the finer ones before it.
void load_parts_with_field(const DrawingArguments& arguments, const PictureRequest& request,
                           const RenderRanks& ranks, DividedVolumes part, SceneInputs& inputs) {
    std::vector<Volume> volumes;
    for (VolumeSet& set : part.sets) {
        if (part.is_mesh)
            volumes.push_back(std::move(set.volumes.back()));
        else
            std::ranges::move(set.volumes, std::back_inserter(volumes));
    }
    std::erase_if(volumes, [](const Volume& volume) { return volume.empty(); });
    inputs.active_voxels = static_cast<std::uint64_t>(count_voxels(volumes, ranks));
    std::vector<FieldCoverage> coverage(1);
    std::vector<VoxelField> values;
    std::vector<std::string> notes;
    if (!volumes.empty()) values = read_shown_field(arguments, request, volumes, notes, &coverage);
    notes.clear();
    const SharedField field = shared_field(volumes, values, coverage.front(), ranks, notes);
    add_notes(notes, ranks, inputs);
    inputs.field = field.name;
    if (!part.is_mesh) {
        VolumeSet all;
        all.volumes = std::move(volumes);
        add_source(std::move(all), std::move(values), field, inputs);
        return;
    }
    for (std::size_t n = 0; n < part.sets.size(); ++n) {
        VolumeSet& levels = part.sets[n];
        levels.volumes.back() = std::move(volumes[n]);
        std::vector<VoxelField> fields;
        for (std::size_t finer = 0; finer + 1 < levels.volumes.size(); ++finer)
            fields.push_back(any_field(levels.volumes[finer], levels.volumes.back(), values[n]));
        fields.push_back(std::move(values[n]));
        add_source(std::move(levels), std::move(fields), field, inputs);
    }
    if (inputs.scene.sources.empty()) {
        VolumeSet none;
        none.overlap = Overlap::hide;
        add_source(std::move(none), {}, field, inputs);
    }
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

/// Parts of a volume with values below 0: every active voxel counts as 1, and the values are a field.
/// returns  nothing for other volumes
std::optional<SharedField> load_divided_signed(const DrawingArguments& arguments,
                                               const std::string& text, bool beside,
                                               const RenderRanks& ranks, PartsWithField& data,
                                               DividedVolumes& part, SceneInputs& inputs) {
    if (!may_be_signed(arguments.volume)) return std::nullopt;
    VolumeInputOptions options = arguments.volume;
    options.ones = true;
    part = ranks.load_volumes(arguments, options, beside);
    if (part.failure) std::rethrow_exception(part.failure);
    if (part.volumes > 1 || part.is_mesh) return std::nullopt;
    data = visible_volumes(part);
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
    std::vector<std::string> notes;
    const SharedField field = shared_field(data.volumes, data.field, coverage, ranks, notes);
    if (!(field.lower < 0) || field.is_vector) return std::nullopt;
    notes.push_back(signed_note(arguments.inputs.front(), field.lower, field.upper));
    add_notes(notes, ranks, inputs);
    return field;
}

/// Parts that do not hide each other, for volume pictures.
void load_visible_parts(const DrawingArguments& arguments, const PictureRequest& request,
                        const RenderRanks& ranks, bool beside, DividedVolumes& part,
                        SceneInputs& inputs) {
    PartsWithField data;
    std::optional<SharedField> field;
    if (const std::exception_ptr failure = part.failure) {
        field = load_divided_signed(arguments, request.field, beside, ranks, data, part, inputs);
        if (!field) std::rethrow_exception(failure);
    } else {
        data = visible_volumes(part);
        FieldCoverage coverage;
        std::vector<std::string> notes;
        read_divided_field(data, coverage,
                           [&](std::vector<Volume>& volumes, std::vector<FieldCoverage>& counts) {
                               return read_shown_field(arguments, request, volumes, notes, &counts);
                           });
        notes.clear();
        field = shared_field(data.volumes, data.field, coverage, ranks, notes);
        add_notes(notes, ranks, inputs);
    }
    // Of parts of a mesh: some may overlap where its lattices do not fit.
    double overlap = data.overlap ? 1 : 0;
    ranks.collective.max(std::span(&overlap, 1));
    inputs.active_voxels = static_cast<std::uint64_t>(count_voxels(data.volumes, ranks));
    inputs.field = field->name;
    VolumeSet all;
    all.volumes = std::move(data.volumes);
    add_source(std::move(all), std::move(data.field), *field, inputs);
    VoxelSource& source = std::get<VoxelSource>(inputs.scene.sources.front());
    source.overlap = overlap > 0;
    source.beside = std::move(data.beside);
    source.beside_field = std::move(data.beside_field);
}

}  // namespace

void require_addable(const PictureRequest& request, FileKind kind) {
    const std::string show = fmt::format("--show {}", word_of(request.show));
    const bool by_value = is_by_value(request.show);
    const bool linear = request.options.voxels.interpolation == Interpolation::linear;
    if (request.options.trace.stop_transmittance > 0)
        throw UsageError(
            "--set stop-transmittance works only in vog render: a rank does not know the "
            "transmittance in front of its part of a ray");
    if (kind == FileKind::volume && linear && (by_value || request.options.voxels.step_voxels > 0))
        throw UsageError(fmt::format(
            "{} with --interpolation linear: samples begin where a ray enters the whole volume, "
            "and a rank holds only a part of it; use {}, or vog render",
            show, by_value ? "--interpolation constant" : "--set step=0 (exact, cell by cell)"));
    if (*request.renderer == Renderer::trace && by_value)
        throw UsageError(
            fmt::format("--renderer trace: {} needs all Gaussians of a ray in their order, and a "
                        "rank holds only some of them; use --renderer splat, or vog render",
                        show));
    const bool on_gpu = *request.renderer == Renderer::cuda || *request.renderer == Renderer::optix;
    const bool volumes_of_field = kind == FileKind::volume && shows_field(request);
    if (on_gpu && (by_value || volumes_of_field))
        throw Error(fmt::format("{}: {} cannot draw parts of a {}; use {}", show,
                                info_of(*request.renderer).name,
                                kind == FileKind::volume ? "volume" : "model",
                                kind == FileKind::volume ? "reference" : "splat"));
}

void require_addable_layers(const DrawingArguments& arguments, const PictureRequest& request) {
    bool models = false, volumes = false;
    for (const Layer& layer : request.layers) {
        if (!layer.visible) continue;
        if (layer.plane)
            throw UsageError("--layer plane: vog-mpi draws no slices in volumes; use vog render");
        const std::vector<std::string> files = expanded({arguments.layer_inputs[layer.input]});
        if (files.size() == 1 && is_surface_file(files.front())) continue;
        const std::string& grid = layer.grid.empty() ? arguments.volume.grid : layer.grid;
        (common_kind(files, grid) == FileKind::volume ? volumes : models) = true;
    }
    if (models && volumes)
        throw UsageError(
            "--layer: vog-mpi draws layers of models or layers of volumes, not both; convert the "
            "volumes to models, or use vog render");
}

void load_divided(const DrawingArguments& arguments, const PictureRequest& request,
                  const RenderRanks& ranks, SceneInputs& inputs) {
    const bool beside = request.show == Show::volume && request.look.light;
    DividedVolumes part = ranks.load_volumes(arguments, arguments.volume, beside);
    if (part.failure && !is_by_value(request.show)) std::rethrow_exception(part.failure);
    if (part.is_mesh && request.options.voxels.interpolation == Interpolation::linear)
        throw UsageError(
            "--interpolation linear: at the edge of a part, levels of a mesh need values that "
            "other ranks hold; use --interpolation constant, or vog render");
    if (is_by_value(request.show))
        load_visible_parts(arguments, request, ranks, beside, part, inputs);
    inputs.scene.subject = part.subject;
    inputs.notes.insert(inputs.notes.begin(), part.notes.begin(), part.notes.end());
    const std::size_t levels = part.is_mesh ? part.volumes : 0;
    if (shows_field(request) && !is_by_value(request.show))
        load_parts_with_field(arguments, request, ranks, std::move(part), inputs);
    else if (!is_by_value(request.show))
        load_parts(std::move(part), inputs);
    inputs.set_primitives_text(levels);
}

}  // namespace vog::cli
