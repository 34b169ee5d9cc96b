// volume_fields.cpp: reading of fields, one volume after another.
#include "fields/volume_fields.h"

#include <algorithm>
#include <utility>

#include "options/field_options.h"
#include "vog/distributed.h"
#include "vog/volume_io.h"

namespace vog::cli {

namespace {

/// Whether a source is the volume's own grid.
bool is_own(const FieldSource& source, const Volume& volume) {
    return source.file == volume.source && source.grid == volume.name;
}

/// Reads one field more. Fields without values need no division of tiles.
VoxelField read_beside(const FieldSource& source, Volume& volume, std::vector<VoxelField>& fields,
                       std::vector<std::string>& notes) {
    std::vector<VoxelField> sampled;
    for (VoxelField& field : fields)
        if (!without_values(field)) sampled.push_back(std::move(field));
    VoxelField read = read_field(source, volume, sampled, &notes);
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

std::string own_name(const std::vector<Volume>& volumes) {
    const std::string& name = volumes.front().name;
    const auto same = [&](const Volume& volume) { return volume.name == name; };
    return !name.empty() && std::ranges::all_of(volumes, same) ? name : "density";
}

std::vector<VoxelField> own_values(const std::vector<Volume>& volumes) {
    std::vector<VoxelField> fields;
    for (const Volume& volume : volumes) fields.push_back(measure_field(volume, own_name(volumes)));
    return fields;
}

std::vector<std::vector<VoxelField>> read_volume_fields(const FieldTexts& given,
                                                        std::vector<Volume>& volumes,
                                                        std::vector<std::string>& notes) {
    const std::vector<FieldSource> sources = parse_fields(given.texts);
    const auto at = [&](const FieldSource& source, const Volume& volume) {
        return field_of_level(source, given.pattern, LevelSource{volume.source, volume.name});
    };
    const std::string name = own_name(volumes);
    const bool own =
        given.own && std::ranges::none_of(sources, [&](const FieldSource& source) {
            return source.name == name || is_own(at(source, volumes.front()), volumes.front());
        });
    std::vector<std::vector<VoxelField>> all(sources.size() + (own ? 1 : 0));
    for (Volume& volume : volumes) {
        // One volume at a time: its tiles are divided for all fields.
        std::vector<VoxelField> fields;
        for (const FieldSource& any : sources) {
            const FieldSource source = at(any, volume);
            fields.push_back(is_own(source, volume)
                                 ? measure_field(volume, source.name.empty() ? name : source.name)
                                 : read_beside(source, volume, fields, notes));
        }
        if (own) fields.push_back(measure_field(volume, name));
        for (std::size_t f = 0; f < all.size(); ++f) {
            if (!all[f].empty()) fields[f].name = all[f].front().name;
            all[f].push_back(std::move(fields[f]));
        }
    }
    return all;
}

}  // namespace vog::cli
