// volume_fields.cpp: reading of fields, one volume after another.
#include "fields/volume_fields.h"

#include <algorithm>
#include <utility>

#include "options/field_options.h"
#include "vog/distributed.h"
#include "vog/volume_io.h"

namespace vog::cli {

namespace {

/// The volume's own values, which need no copy.
VoxelField measure_field(const Volume& volume, const std::string& name) {
    VoxelField field;
    field.name = name.empty() ? "density" : name;
    field.component.resize(1);
    bool any = false;
    const auto include = [&](float value) {
        const double number{value};
        field.lower = any ? std::min(field.lower, number) : number;
        field.upper = any ? std::max(field.upper, number) : number;
        any = true;
    };
    for (const Leaf& leaf : volume.leaves)
        for (int n = 0; n < kLeafVoxels; ++n)
            if (leaf.active(n)) include(leaf.value[static_cast<std::size_t>(n)]);
    for (const Tile& tile : volume.tiles) include(tile.value);
    return field;
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

std::vector<VoxelField> own_values(const std::vector<Volume>& volumes) {
    std::vector<VoxelField> fields;
    for (const Volume& volume : volumes) fields.push_back(measure_field(volume, volume.name));
    return fields;
}

std::vector<std::vector<VoxelField>> read_volume_fields(const std::vector<std::string>& texts,
                                                        const std::string& pattern,
                                                        std::vector<Volume>& volumes,
                                                        std::vector<std::string>& notes) {
    const std::vector<FieldSource> sources = parse_fields(texts);
    std::vector<std::vector<VoxelField>> all(sources.size());
    for (Volume& volume : volumes) {
        // One volume at a time: its tiles are divided for all fields.
        std::vector<VoxelField> fields;
        for (const FieldSource& any : sources) {
            const FieldSource source =
                field_of_level(any, pattern, LevelSource{volume.source, volume.name});
            const bool own = source.file == volume.source && source.grid == volume.name;
            fields.push_back(own ? measure_field(volume, source.name)
                                 : read_beside(source, volume, fields, notes));
        }
        for (std::size_t f = 0; f < all.size(); ++f) {
            if (!all[f].empty()) fields[f].name = all[f].front().name;
            all[f].push_back(std::move(fields[f]));
        }
    }
    return all;
}

}  // namespace vog::cli
