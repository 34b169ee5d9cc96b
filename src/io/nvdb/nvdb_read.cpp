// nvdb_read.cpp: choice of a grid in a .nvdb file, and its conversion to density.
#include <fmt/core.h>

#include <utility>

#include "io/nvdb/nvdb_file.h"
#include "io/nvdb/nvdb_grid.h"
#include "io/vdb/vdb_density.h"
#include "io/vdb/vdb_volume.h"
#include "vog/volume_io.h"

namespace vog {

using namespace nvdb;
using namespace vdb;

const NvdbEntry& nvdb::chosen_entry(const NvdbFile& file, const GridRequest& request,
                                    DefaultGrid* answer, bool level_sets) {
    const auto kind_of = [](const NvdbEntry& entry) {
        const bool is_switch =
            entry.type == nanovdb::GridType::Boolean || entry.type == nanovdb::GridType::Mask;
        return is_scalar(entry.type) ? ValueKind::numbers
               : is_switch           ? ValueKind::switches
                                     : ValueKind::others;
    };
    return chosen_of(
        file.entries(), file.name(), request, answer, kind_of, [&](const NvdbEntry& entry) {
            return entry.level_set == level_sets ? static_cast<double>(entry.voxels) : 0;
        });
}

namespace {

/// Converts leaves directly from the file; only tiles pass through an OpenVDB tree.
Volume density_of(const NanoBuffer& buffer, const std::string& where, const VdbOptions& options,
                  ValueNotes& notes) {
    NanoLeaves from;
    const openvdb::GridBase::Ptr grid = grid_from_nano(buffer, where, &from);
    if (grid->getGridClass() == openvdb::GRID_LEVEL_SET && !options.ones)
        throw Error(fmt::format(
            "{}: a level set, expected density (--level-set-to-fog converts it)", where));
    Volume volume;
    volume.world_from_index = nano_transform(buffer);
    check_transform(volume.world_from_index, where);
    volume.leaves = std::move(from.leaves);
    const Census tiles = tiles_from_grid(*grid, volume);
    check_census(leaves_then_tiles(from.census, tiles), value_rules(options), where, notes);
    drop_empty_leaves(volume);
    if (options.ones) set_ones(volume, notes);
    if (options.mask) {
        keep_positive(volume);
        notes = {};
    }
    return volume;
}

Volume fog_of_level_set(const NanoBuffer& buffer, const std::string& where,
                        const VdbOptions& options, ValueNotes& notes) {
    const openvdb::GridBase::Ptr grid = grid_from_nano(buffer, where);
    level_set_to_fog(*grid, where);
    Volume fog = density_from_grid(*grid, nano_transform(buffer), where, notes, options.mask);
    if (options.ones) set_ones(fog, notes);
    return fog;
}

}  // namespace

std::vector<std::string> nvdb_grid_names(const std::filesystem::path& path) {
    const NvdbFile file(path);
    std::vector<std::string> list;
    for (const NvdbEntry& entry : file.entries()) list.push_back(entry.name);
    return list;
}

DefaultGrid nvdb::default_grid(const std::filesystem::path& path, const VdbOptions& options,
                               bool levels) {
    DefaultGrid answer;
    chosen_entry(NvdbFile(path), {{}, options.refuse_several, levels}, &answer,
                 options.level_set_to_fog);
    return answer;
}

Volume read_nvdb(const std::filesystem::path& path, const VdbOptions& options, ValueNotes* notes) {
    openvdb::initialize();
    NvdbFile file(path);
    const NvdbEntry& entry = chosen_entry(file, {options.grid, options.refuse_several}, nullptr,
                                          options.level_set_to_fog);
    const std::string where = file.where(entry);
    return with_vdb_errors(where, [&] {
        const NanoBuffer buffer = file.load(entry);
        ValueNotes found;
        Volume volume = options.level_set_to_fog ? fog_of_level_set(buffer, where, options, found)
                                                 : density_of(buffer, where, options, found);
        if (volume.empty())
            throw Error(fmt::format("{}: no active voxels{}", where,
                                    options.mask ? " above 0, expected a mask" : ""));
        volume.name = entry.plain_name;
        volume.source = printable(file.name());
        if (notes) *notes = found;
        return volume;
    });
}

std::vector<GridInfo> nvdb::inspect_nvdb(const std::filesystem::path& path) {
    openvdb::initialize();
    NvdbFile file(path);
    std::vector<GridInfo> infos;
    for (const NvdbEntry& entry : file.entries()) {
        const std::string where = file.where(entry);
        with_vdb_errors(where, [&] {
            const NanoBuffer buffer = file.load(entry);
            GridInfo info;
            info.name = entry.name;
            info.world_from_index = nano_transform(buffer);
            info.type = nano_type_name(entry.type);
            if (is_readable(entry.type)) {
                const openvdb::GridBase::Ptr grid = grid_from_nano(buffer, where);
                info.type = short_type(grid->type());
                info.grid_class = openvdb::GridBase::gridClassToString(grid->getGridClass());
                describe_grid(*grid, info);
            }
            infos.push_back(info);
        });
    }
    return infos;
}

}  // namespace vog
