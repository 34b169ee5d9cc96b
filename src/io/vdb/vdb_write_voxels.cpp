// vdb_write_voxels.cpp: a volume and fields at its voxels as grids of one file, with one leaf's values in OpenVDB's
// memory at a time.
#include <algorithm>
#include <set>

#include "core/paging.h"
#include "io/file_extension.h"
#include "io/nvdb/nvdb_file.h"
#include "io/nvdb/nvdb_write.h"
#include "io/vdb/vdb_volume.h"
#include "vog/voxel_field.h"

namespace vog {

using namespace vdb;

namespace {

openvdb::Coord coord_of(Vec3i v) { return {v.x, v.y, v.z}; }

/// Copies the values of leaf `n` to a leaf of OpenVDB's.
struct DensityOf {
    const Volume& volume;
    float tile(std::size_t n) const { return volume.tiles[n].value; }
    void operator()(std::size_t n, float* to) const {
        std::ranges::copy(volume.leaves[n].value, to);
    }
};
struct ScalarOf {
    const VoxelField& field;
    float tile(std::size_t n) const { return field.component[0].tile[n]; }
    void operator()(std::size_t n, float* to) const {
        std::ranges::copy(field.component[0].leaf[n], to);
    }
};
struct VectorOf {
    const VoxelField& field;
    openvdb::Vec3s tile(std::size_t n) const {
        return {field.component[0].tile[n], field.component[1].tile[n], field.component[2].tile[n]};
    }
    void operator()(std::size_t n, openvdb::Vec3s* to) const {
        for (std::size_t voxel = 0; voxel < kLeafVoxels; ++voxel)
            to[voxel] = {field.component[0].leaf[n][voxel], field.component[1].leaf[n][voxel],
                         field.component[2].leaf[n][voxel]};
    }
};

/// Grid with the tiles of a volume, its leaves, their masks, and no values of these yet.
template <class GridT, class Values>
typename GridT::Ptr grid_without_values(const Volume& volume, const std::string& name,
                                        const Values& values) {
    using LeafT = typename GridT::TreeType::LeafNodeType;
    openvdb::initialize();
    const auto grid = GridT::create();
    grid->setName(name);
    set_transform(*grid, volume.world_from_index, volume.source.empty() ? "volume" : volume.source);
    for (std::size_t n = 0; n < volume.tiles.size(); ++n)
        grid->tree().addTile(tile_level(volume.tiles[n].edge), coord_of(volume.tiles[n].origin),
                             values.tile(n), true);
    for (const Leaf& from : volume.leaves) {
        auto* const leaf = new LeafT(openvdb::PartialCreate(), coord_of(from.origin));
        typename LeafT::NodeMaskType mask;
        for (openvdb::Index word = 0; word < from.mask.size(); ++word)
            mask.template getWord<openvdb::Index64>(word) = from.mask[word];
        leaf->setValueMask(mask);
        grid->tree().addLeaf(leaf);  // the tree owns it
        keep_memory();
    }
    grid->addStatsMetadata();
    return grid;
}

/// Place of the leaf with this origin in the volume, whose leaves are sorted.
std::size_t place_of(const Volume& volume, const openvdb::Coord& origin) {
    const auto found = std::ranges::lower_bound(
        volume.leaves, origin, {}, [](const Leaf& leaf) { return coord_of(leaf.origin); });
    return static_cast<std::size_t>(found - volume.leaves.begin());
}

/// Grid of values(leaf number, first value of 512) at a volume's voxels, written leaf by leaf: only one has values in
/// memory.
template <class GridT, class Values>
GridToWrite streamed_grid(const Volume& volume, const std::string& name, const Values& values) {
    using LeafT = typename GridT::TreeType::LeafNodeType;
    const typename GridT::Ptr grid = grid_without_values<GridT>(volume, name, values);
    return {grid, [&volume, grid, values](std::ostream& out) {
                // The order of Tree::writeBuffers.
                for (auto leaf = grid->tree().beginLeaf(); leaf; ++leaf) {
                    leaf->buffer().allocate();
                    values(place_of(volume, leaf->origin()), leaf->buffer().data());
                    leaf->writeBuffers(out, false);
                    typename LeafT::Buffer none(openvdb::PartialCreate(), {});
                    leaf->buffer().swap(none);
                    keep_memory();
                }
            }};
}

/// The same grid with all values in memory.
template <class GridT, class Values>
openvdb::GridBase::Ptr filled_grid(const Volume& volume, const std::string& name,
                                   const Values& values) {
    const typename GridT::Ptr grid = grid_without_values<GridT>(volume, name, values);
    for (auto leaf = grid->tree().beginLeaf(); leaf; ++leaf) {
        leaf->buffer().allocate();
        values(place_of(volume, leaf->origin()), leaf->buffer().data());
    }
    return grid;
}

/// Calls make(grid type, name, values) for the volume, n = 0, or field n - 1.
template <class Make>
auto make_grid(const Volume& volume, std::span<const VoxelField> fields, std::size_t n,
               const Make& make) {
    if (n == 0)
        return make(std::type_identity<openvdb::FloatGrid>{}, volume.name, DensityOf{volume});
    const VoxelField& field = fields[n - 1];
    if (field.is_vector())
        return make(std::type_identity<openvdb::Vec3SGrid>{}, field.name, VectorOf{field});
    return make(std::type_identity<openvdb::FloatGrid>{}, field.name, ScalarOf{field});
}

void describe(openvdb::GridBase& grid, const Volume& volume, std::span<const VoxelField> fields,
              std::size_t n) {
    if (n == 0) grid.setGridClass(openvdb::GRID_FOG_VOLUME);
    set_metadata(grid, {volume.units.length, n == 0 ? volume.units.density : fields[n - 1].unit},
                 volume.standing);
}

/// throws vog::Error unless fields fit the volume
/// names  of the grids before; receives those of these
void check_voxels(const Volume& volume, std::span<const VoxelField> fields,
                  std::set<std::string>& names, const std::string& where) {
    validate(volume);
    if (volume.empty()) throw Error(fmt::format("{}: cannot write: no active voxels", where));
    const auto add = [&](const std::string& name) {
        if (name.empty() || !names.insert(name).second)
            throw Error(fmt::format("{}: cannot write: several grids named '{}'", where, name));
    };
    add(volume.name);
    for (const VoxelField& field : fields) {
        add(field.name);
        for (const VoxelValues& component : field.component)
            if (component.leaf.size() != volume.leaves.size() ||
                component.tile.size() != volume.tiles.size() ||
                (field.component.size() != 1 && !field.is_vector()))
                throw Error(
                    fmt::format("{}: cannot write: field '{}' of {} leaves, {} tiles and {} "
                                "components, expected {} leaves, {} tiles and 1 or 3",
                                where, field.name, component.leaf.size(), component.tile.size(),
                                field.component.size(), volume.leaves.size(), volume.tiles.size()));
    }
}

}  // namespace

void write_voxels(const std::filesystem::path& file, const Volume& volume,
                  std::span<const VoxelField> fields) {
    const VoxelGrids one{&volume, fields};
    write_voxels(file, std::span(&one, 1));
}

void write_voxels(const std::filesystem::path& file, std::span<const VoxelGrids> volumes) {
    const std::string where = file.string();
    std::set<std::string> names;
    std::vector<std::pair<const VoxelGrids*, std::size_t>> grids;
    for (const VoxelGrids& one : volumes) {
        check_voxels(*one.volume, one.fields, names, where);
        for (std::size_t n = 0; n <= one.fields.size(); ++n) grids.emplace_back(&one, n);
    }
    if (lower_extension(file) == ".nvdb")
        return nvdb::write_nvdb_grids(file, grids.size(), [&](std::size_t g) {
            const auto [from, n] = grids[g];
            const Volume& volume = *from->volume;
            const auto grid = make_grid(
                volume, from->fields, n,
                [&](auto type, const std::string& name, const auto& values) {
                    return filled_grid<typename decltype(type)::type>(volume, name, values);
                });
            describe(*grid, volume, from->fields, n);
            return grid;
        });
    if (lower_extension(file) != ".vdb")
        throw Error(fmt::format("{}: cannot write: expected a .vdb or .nvdb", where));
    write_vdb_grids(file, grids.size(), [&](std::size_t g) {
        const auto [from, n] = grids[g];
        const Volume& volume = *from->volume;
        const GridToWrite write = make_grid(
            volume, from->fields, n, [&](auto type, const std::string& name, const auto& values) {
                return streamed_grid<typename decltype(type)::type>(volume, name, values);
            });
        describe(*write.grid, volume, from->fields, n);
        return write;
    });
}

}  // namespace vog
