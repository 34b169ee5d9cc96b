// field_grid.cpp: reading of a field's grid from .vdb, .nvdb and dense files, and its vector type.
#include "io/fields/field_grid.h"

#include <fmt/core.h>

#include "io/nvdb/nvdb_file.h"
#include "io/nvdb/nvdb_grid.h"
#include "io/scan/scan_file.h"
#include "io/scan/scan_volume.h"
#include "io/vdb/vdb_density.h"
#include "io/vdb/vdb_grid.h"
#include "vog/error.h"

namespace vog::field_files {

using namespace vdb;

namespace {

/// Vectors in world space are along its axes whatever their type, which states how they follow
/// when the grid is moved; those in local space are moved with it here.
/// throws vog::Error for a type that OpenVDB does not have
VectorMap vector_map(const VdbMetadata& metadata, const Affine& world_from_index,
                     const std::string& where) {
    if (!metadata.local_space) return {};
    const std::string& type = metadata.vector_type;
    if (type.empty() || type == "invariant") return {};
    if (type == "covariant" || type == "covariant normalize")
        return {transpose(inverse(world_from_index.linear)), {}, type != "covariant"};
    if (type == "contravariant relative") return {world_from_index.linear, {}};
    if (type == "contravariant absolute")
        return {world_from_index.linear, world_from_index.translation};
    throw Error(
        fmt::format("{}: vectors of type '{}', expected invariant, covariant, covariant normalize, "
                    "contravariant relative or contravariant absolute",
                    where, printable(type)));
}

FieldGrid load_vdb(const FieldSource& source) {
    VdbFile file(source.file);
    const VdbEntry& entry = chosen_entry(file, {source.grid, true});
    FieldGrid field;
    field.name = entry.plain_name;
    field.where = file.where(entry);
    LoadedGrid loaded = load_grid(file, entry);
    if (!loaded.grid || loaded.has_points)
        throw Error(fmt::format("{}: holds {}, expected numbers or vectors", field.where,
                                short_type(entry.tree_type)));
    check_transform(loaded.head.world_from_index, field.where);
    field.grid = loaded.grid;
    field.world_from_index = *loaded.head.world_from_index;
    field.unit = loaded.head.metadata.unit;
    field.length_unit = loaded.head.metadata.length_unit;
    field.world_from_vector = vector_map(loaded.head.metadata, field.world_from_index, field.where);
    return field;
}

FieldGrid load_nvdb(const FieldSource& source) {
    nvdb::NvdbFile file(source.file);
    const nvdb::NvdbEntry& entry = nvdb::chosen_entry(file, {source.grid, true});
    FieldGrid field;
    field.name = entry.plain_name;
    field.where = file.where(entry);
    with_vdb_errors(field.where, [&] {
        const NanoBuffer buffer = file.load(entry);
        field.grid = nvdb::grid_from_nano(buffer, field.where);
        field.world_from_index = nvdb::nano_transform(buffer);
    });
    check_transform(field.world_from_index, field.where);
    return field;
}

void require_file(const FieldSource& source) {
    if (source.file.empty())
        throw Error(fmt::format("field '{}': no file, expected a .vdb, .nvdb or dense image",
                                printable(source.name.empty() ? source.grid : source.name)));
}

}  // namespace

Vec3d VectorMap::operator()(Vec3d v) const {
    const Vec3d mapped = linear * v + shift;
    const double size = length(mapped);
    return normalize && size > 0 ? (1 / size) * mapped : mapped;
}

FieldGrid load_field_grid(const FieldSource& source) {
    require_file(source);
    openvdb::initialize();
    FieldGrid field = nvdb::is_nvdb(source.file)   ? load_nvdb(source)
                      : scan::is_scan(source.file) ? scan::load_scan_field(source)
                                                   : load_vdb(source);
    field.staggered = field.grid->getGridClass() == openvdb::GRID_STAGGERED;
    field.level_set = field.grid->getGridClass() == openvdb::GRID_LEVEL_SET;
    if (!source.name.empty()) field.name = source.name;
    if (!source.unit.empty()) field.unit = source.unit;
    return field;
}

std::string name_of(const FieldSource& source) {
    require_file(source);
    openvdb::initialize();
    const auto plain_name = [&](auto file) {
        return chosen_entry(file, {source.grid, true}).plain_name;
    };
    const std::string grid = nvdb::is_nvdb(source.file)   ? plain_name(nvdb::NvdbFile(source.file))
                             : scan::is_scan(source.file) ? scan::scan_field_name(source)
                                                          : plain_name(VdbFile(source.file));
    return source.name.empty() ? grid : source.name;
}

}  // namespace vog::field_files
