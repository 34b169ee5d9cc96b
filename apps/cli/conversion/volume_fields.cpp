// volume_fields.cpp: reading of fields, one volume after another.
#include "conversion/volume_fields.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "options/field_options.h"
#include "vog/distributed.h"
#include "vog/text.h"
#include "vog/volume_io.h"

namespace vog::cli {

namespace {

/// File and grid of a volume.
LevelSource source_of(const Volume& volume, const std::vector<std::string>& inputs) {
    const auto file = std::ranges::find_if(
        inputs, [&](const std::string& input) { return printable(input) == volume.source; });
    return {file == inputs.end() ? volume.source : *file, volume.name};
}

bool same_grid(const FieldSource& field, const LevelSource& volume) {
    return field.file == volume.file && field.grid == volume.grid;
}

/// The fields of --field, and the own values where they are added: without file and grid.
std::vector<FieldSource> sources_of(const FieldTexts& given, std::span<const Volume> volumes) {
    std::vector<FieldSource> sources = parse_fields(given.texts);
    if (given.own.empty()) return sources;
    const LevelSource first = source_of(volumes.front(), given.inputs);
    const auto is_own = [&](const FieldSource& source) {
        return source.name == given.own ||
               same_grid(field_of_level(source, given.pattern, first), first);
    };
    if (std::ranges::none_of(sources, is_own)) sources.push_back({.name = given.own});
    return sources;
}

/// Reads one field more. Fields without values need no division of tiles.
VoxelField read_beside(const FieldSource& source, Volume& volume, std::vector<VoxelField>& fields,
                       std::vector<std::string>& notes, FieldCoverage* coverage) {
    std::vector<VoxelField> sampled;
    for (VoxelField& field : fields)
        if (!without_values(field)) sampled.push_back(std::move(field));
    VoxelField read = read_field(source, volume, sampled, &notes, coverage);
    auto next = sampled.begin();
    for (VoxelField& field : fields)
        if (field.component.empty()) field = std::move(*next++);  // moved from
    return read;
}

}  // namespace

bool without_values(const VoxelField& field) {
    const VoxelValues& values = field.component.front();
    return values.leaf.empty() && values.tile.empty();
}

std::string own_name(std::span<const Volume> volumes) {
    if (volumes.empty()) return {};
    const std::string& name = volumes.front().name;
    const auto same = [&](const Volume& volume) { return volume.name == name; };
    return !name.empty() && std::ranges::all_of(volumes, same) ? name : "density";
}

std::vector<VoxelField> own_values(const std::vector<Volume>& volumes) {
    std::vector<VoxelField> fields;
    for (const Volume& volume : volumes) fields.push_back(measure_field(volume, own_name(volumes)));
    return fields;
}

std::vector<FieldName> names_of(const FieldTexts& given, std::span<const Volume> volumes) {
    std::vector<FieldName> names;
    const LevelSource first = source_of(volumes.front(), given.inputs);
    for (const FieldSource& source : sources_of(given, volumes)) {
        const FieldSource at = field_of_level(source, given.pattern, first);
        const bool own = (source.grid.empty() && source.file.empty()) || same_grid(at, first);
        const std::string name = own && !source.name.empty() ? source.name : field_name(at);
        names.push_back({own && name.empty() ? "density" : name, own});
    }
    return names;
}

std::vector<std::vector<VoxelField>> read_volume_fields(const FieldTexts& given,
                                                        std::span<Volume> volumes,
                                                        std::vector<std::string>& notes,
                                                        std::vector<FieldCoverage>* coverage) {
    const std::vector<FieldSource> sources = sources_of(given, volumes);
    std::vector<std::vector<VoxelField>> all(sources.size());
    if (coverage) coverage->resize(sources.size());
    const bool are_parts = !given.labels.empty();
    const auto add_note = [&](const std::string& note) {
        if (!note.empty()) notes.push_back(note);
    };
    for (Volume& volume : volumes) {
        // One volume at a time: its tiles are divided for all fields.
        const LevelSource from = source_of(volume, given.inputs);
        std::vector<VoxelField> fields;
        for (std::size_t f = 0; f < sources.size(); ++f) {
            const bool added = f >= given.texts.size();
            const FieldSource source =
                added ? FieldSource{.file = from.file, .grid = from.grid, .name = given.own}
                      : field_of_level(sources[f], given.pattern, from);
            if (same_grid(source, from) && !given.ones) {
                fields.push_back(
                    measure_field(volume, source.name.empty() ? "density" : source.name));
                continue;
            }
            FieldCoverage one;
            fields.push_back(
                read_beside(source, volume, fields, notes, coverage || are_parts ? &one : nullptr));
            if (coverage)
                (*coverage)[f].add(one);
            else if (are_parts && (added || given.texts[f] != given.labels))
                add_note(one.covered_voxels > 0
                             ? coverage_note(one)
                             : fmt::format("{}: inactive at all voxels of one label; the field has "
                                           "its background value there",
                                           one.grid));
        }
        for (std::size_t f = 0; f < all.size(); ++f) {
            if (!all[f].empty()) fields[f].name = all[f].front().name;
            all[f].push_back(std::move(fields[f]));
        }
    }
    return all;
}

}  // namespace vog::cli
