// vdb_read.cpp: one grid of a .vdb file as density: which one, what is refused, what is said.
#include <fmt/ranges.h>

#include "io/vdb_volume.h"
#include "vog/vdb.h"

namespace vog {

namespace {

std::string names(const std::vector<VdbEntry>& entries) {
    std::vector<std::string> list;
    for (const VdbEntry& entry : entries) list.push_back(entry.name);
    return fmt::format("{}", fmt::join(list, ", "));
}

/// The one among `candidates`, if there is just one.
const VdbEntry* the_only(const std::vector<const VdbEntry*>& candidates) {
    return candidates.size() == 1 ? candidates.front() : nullptr;
}

const VdbEntry& entry_named(const VdbFile& file, const std::string& name) {
    std::vector<const VdbEntry*> shown, plain;
    for (const VdbEntry& entry : file.entries()) {
        if (entry.name == name) shown.push_back(&entry);
        if (entry.plain_name == name) plain.push_back(&entry);
    }
    if (const VdbEntry* entry = the_only(shown)) return *entry;
    if (const VdbEntry* entry = the_only(plain)) return *entry;
    throw Error(fmt::format("{}: {} named '{}' (it has: {})", file.name(),
                            plain.empty() ? "no grid" : "several grids", name,
                            names(file.entries())));
}

/// The only scalar grid, else the one named density.
const VdbEntry& default_entry(const VdbFile& file) {
    std::vector<const VdbEntry*> scalar, density;
    for (const VdbEntry& entry : file.entries()) {
        if (!is_scalar(entry.tree_type)) continue;
        scalar.push_back(&entry);
        if (entry.plain_name == "density") density.push_back(&entry);
    }
    if (const VdbEntry* entry = the_only(scalar)) return *entry;
    if (const VdbEntry* entry = the_only(density)) return *entry;
    if (scalar.empty())
        throw Error(fmt::format("{}: no scalar grid (it has: {}); vectors are read when named",
                                file.name(), names(file.entries())));
    throw Error(
        fmt::format("{}: {} scalar grids, expected one, or one named 'density', or a name "
                    "(it has: {})",
                    file.name(), scalar.size(), names(file.entries())));
}

}  // namespace

std::vector<std::string> vdb_grid_names(const std::filesystem::path& path) {
    const VdbFile file(path);
    std::vector<std::string> list;
    for (const VdbEntry& entry : file.entries()) list.push_back(entry.name);
    return list;
}

Volume read_vdb(const std::filesystem::path& path, const VdbOptions& options, VdbNotes* notes) {
    openvdb::initialize();
    VdbFile file(path);
    if (file.entries().empty()) throw Error(fmt::format("{}: no grids", file.name()));
    const VdbEntry& entry =
        options.grid.empty() ? default_entry(file) : entry_named(file, options.grid);
    const std::string where = file.where(entry);

    const LoadedGrid loaded = load_grid(file, entry);
    if (!loaded.grid || loaded.has_points)
        throw Error(fmt::format("{}: holds {}, expected float, double, int32, int64 or vec3", where,
                                short_type(entry.tree_type)));
    return with_vdb_errors(where, [&] {
        openvdb::GridBase& grid = *loaded.grid;
        if (options.level_set_to_fog)
            level_set_to_fog(grid, where);
        else if (grid.getGridClass() == openvdb::GRID_LEVEL_SET)
            throw Error(fmt::format(
                "{}: a level set, expected density (--level-set-to-fog makes fog of it)", where));

        VdbNotes found;
        Volume volume =
            density_from_grid(grid, loaded.head.world_from_index, where, found, options.mask);
        if (volume.empty())
            throw Error(fmt::format("{}: no active voxels{}", where,
                                    options.mask ? " above 0, expected a mask" : ""));
        volume.name = entry.plain_name;
        volume.source = file.name();
        if (notes) *notes = found;
        return volume;
    });
}

}  // namespace vog
