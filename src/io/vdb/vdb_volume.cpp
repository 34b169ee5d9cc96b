// vdb_volume.cpp: conversion between OpenVDB grids and volumes, for files and for vog/openvdb.h.
#include "io/vdb/vdb_volume.h"

#include <openvdb/tools/LevelSetUtil.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <limits>
#include <sstream>
#include <tuple>
#include <utility>

#include "core/parallel.h"
#include "io/vdb/vdb_density.h"
#include "io/vdb/vdb_transform.h"
#include "vog/openvdb.h"

namespace vog {

using namespace vdb;

namespace {

constexpr std::size_t kLeavesPerTask = 64;

/// Edge of a tile in voxels, by the level of its node: 1 lower, 2 upper, 3 root.
constexpr std::array<std::int32_t, 4> kTileEdge{0, 8, 128, 4096};

constexpr auto kByOrigin = [](const auto& node) {
    return std::tuple(node.origin.x, node.origin.y, node.origin.z);
};

/// Converts leaves with active voxels to volume.leaves, sorted by origin.
template <class GridT>
Census convert_leaves(const GridT& grid, Volume& volume) {
    using LeafT = typename GridT::TreeType::LeafNodeType;
    std::vector<const LeafT*> leaves;
    grid.tree().getNodes(leaves);
    std::erase_if(leaves, [](const LeafT* leaf) { return leaf->isEmpty(); });
    std::ranges::sort(leaves, {}, [](const LeafT* leaf) { return leaf->origin(); });

    volume.leaves.resize(leaves.size());
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, leaves.size(), kLeavesPerTask), Census{},
        [&](const auto& range, Census census) {
            for (std::size_t i = range.begin(); i < range.end(); ++i)
                convert_leaf(*leaves[i], i, volume.leaves[i], census);
            return census;
        },
        Census::sum);
}

template <class GridT>
Census convert_tiles(const GridT& grid, Volume& volume) {
    for_each_tile(grid.tree(), [&](Vec3i origin, std::int32_t edge, const auto& value) {
        volume.tiles.push_back({origin, edge, density(value)});
    });
    return admit_tiles(volume.tiles);
}

template <class GridT>
void convert(const GridT& grid, const ValueRules& rules, const std::string& where, Volume& volume,
             ValueNotes& notes) {
    const Census leaves = convert_leaves(grid, volume);
    check_census(leaves_then_tiles(leaves, convert_tiles(grid, volume)), rules, where, notes);
    drop_empty_leaves(volume);
}

template <class GridT>
void sdf_to_fog(GridT& grid, const std::string& where) {
    // Checked first: the conversion would drop values that are not finite.
    Volume values;
    ValueNotes notes;
    convert(grid, {false, true}, where, values, notes);
    if (!(grid.background() > 0) || !std::isfinite(grid.background()))
        throw Error(fmt::format("{}: background {}, expected the half width of a narrow band > 0",
                                where, grid.background()));
    openvdb::tools::sdfToFogVolume(grid);
}

}  // namespace

Census vdb::admit_tiles(std::vector<Tile>& tiles) {
    Census census;
    std::ranges::sort(tiles, {}, kByOrigin);
    for (std::size_t i = 0; i < tiles.size(); ++i) {
        Tile& one = tiles[i];
        const float admitted = census.admit(one.value, i, one.origin);
        if (std::isfinite(one.value)) one.value = admitted;
    }
    std::erase_if(tiles, [](const Tile& one) { return !std::isfinite(one.value); });
    return census;
}

void vdb::check_census(const Census& census, const ValueRules& rules, const std::string& where,
                       ValueNotes& notes) {
    const auto refuse = [&](const Census::Count& count, const char* what, const char* expected) {
        throw Error(fmt::format(
            "{}: {} active values are {}, the first at index [{}, {}, {}], expected finite "
            "densities >= 0 ({})",
            where, count.values, what, count.index.x, count.index.y, count.index.z, expected));
    };
    if (census.not_finite.values && !rules.skip_nonfinite)
        refuse(census.not_finite, "not finite", "--skip-nonfinite leaves such voxels out");
    if (census.negative.values && !rules.clip_negative)
        refuse(
            census.negative, "negative",
            "--clip-negative sets them to 0, vog convert --measure volume carries them as a field");
    notes = {census.negative.values, census.not_finite.values, census.inactive_not_finite, {}};
    if (census.not_finite.values) notes.first_skipped = census.not_finite.index;
}

void vdb::drop_empty_leaves(Volume& volume) {
    std::erase_if(volume.leaves, [](const Leaf& leaf) { return leaf.active_count() == 0; });
}

void vdb::check_transform(const std::optional<Affine>& world_from_index, const std::string& where) {
    if (!world_from_index)
        throw Error(fmt::format("{}: transform is a frustum, expected an affine one", where));
    const double det = determinant(world_from_index->linear);
    const Vec3d shift = world_from_index->translation;
    if (!std::isfinite(det) || det == 0 || !std::isfinite(shift.x + shift.y + shift.z))
        throw Error(fmt::format(
            "{}: transform is singular or not finite, expected an invertible one", where));
}

void vdb::keep_positive(Volume& volume) {
    for (Leaf& leaf : volume.leaves) {
        Leaf kept;
        kept.origin = leaf.origin;
        for (int n = 0; n < kLeafVoxels; ++n)
            if (leaf.value[static_cast<std::size_t>(n)] > 0) kept.set(n, 1);
        leaf = kept;
    }
    drop_empty_leaves(volume);
    std::erase_if(volume.tiles, [](const Tile& tile) { return tile.value <= 0; });
    for (Tile& tile : volume.tiles) tile.value = 1;
}

Census vdb::leaves_then_tiles(const Census& leaves, Census tiles) {
    for (Census::Count* count : {&tiles.negative, &tiles.not_finite})
        if (count->values > 0) count->first += std::uint64_t{1} << 62;
    return Census::sum(leaves, tiles);
}

void vdb::set_ones(Volume& volume, ValueNotes& notes) {
    vog::parallel_for(std::size_t{0}, volume.leaves.size(), [&](std::size_t i) {
        Leaf& leaf = volume.leaves[i];
        for (int n = 0; n < kLeafVoxels; ++n)
            if (leaf.active(n)) leaf.value[static_cast<std::size_t>(n)] = 1;
    });
    for (Tile& tile : volume.tiles) tile.value = 1;
    notes.clipped_negative = 0;
}

ValueRules vdb::value_rules(const VdbOptions& options) {
    ValueRules rules = options.values;
    if (options.mask || options.ones) rules.clip_negative = true;
    if (options.ones) rules.skip_nonfinite = true;
    return rules;
}

Census vdb::tiles_from_grid(const openvdb::GridBase& grid, Volume& volume) {
    Census census;
    grid.apply<KnownGrids>([&](const auto& typed) { census = convert_tiles(typed, volume); });
    return census;
}

Volume vdb::density_from_grid(const openvdb::GridBase& grid,
                              const std::optional<Affine>& world_from_index,
                              const std::string& where, ValueNotes& notes, bool mask,
                              const ValueRules& rules) {
    check_transform(world_from_index, where);
    Volume volume;
    volume.world_from_index = *world_from_index;
    const auto fill = [&](const auto& typed) {
        convert(typed, value_rules({.mask = mask, .values = rules}), where, volume, notes);
    };
    if (!grid.apply<KnownGrids>(fill)) throw_not_density(where, grid.type());
    if (mask) {
        keep_positive(volume);
        notes = {};
    }
    return volume;
}

void vdb::level_set_to_fog(openvdb::GridBase& grid, const std::string& where) {
    using openvdb::GridBase;
    const openvdb::GridClass kind = grid.getGridClass();
    if (kind != openvdb::GRID_LEVEL_SET && kind != openvdb::GRID_UNKNOWN)
        throw Error(fmt::format("{}: class {}, expected a level set to convert to fog", where,
                                GridBase::gridClassToString(kind)));
    const bool known =
        grid.apply<openvdb::RealGridTypes>([&](auto& typed) { sdf_to_fog(typed, where); });
    if (!known)
        throw Error(fmt::format("{}: a level set of {}, expected float or double", where,
                                short_type(grid.type())));
}

Volume volume_from_grid(const openvdb::FloatGrid& grid) {
    const std::string where = fmt::format("grid '{}'", grid.getName());
    if (grid.getGridClass() == openvdb::GRID_LEVEL_SET)
        throw Error(fmt::format(
            "{}: a level set, expected a fog volume (openvdb::tools::sdfToFogVolume converts it)",
            where));
    std::ostringstream transform;
    grid.transform().write(transform);
    const std::string bytes = transform.str();
    MemoryBytes in(bytes, where, 0);

    ValueNotes notes;
    Volume volume = density_from_grid(grid, read_transform(in), where, notes);
    volume.name = grid.getName();
    return volume;
}

void vdb::set_transform(openvdb::GridBase& grid, const Affine& world_from_index,
                        const std::string& where) {
    with_vdb_errors(where, [&] {
        const std::string bytes = transform_bytes(world_from_index);
        MemoryStream stream(bytes);
        openvdb::io::setCurrentVersion(stream);
        const auto transform = openvdb::math::Transform::createLinearTransform();
        transform->read(stream);
        grid.setTransform(transform);
    });
}

openvdb::Index vdb::tile_level(std::int32_t edge) {
    return static_cast<openvdb::Index>(std::ranges::find(kTileEdge, edge) - kTileEdge.begin());
}

void vdb::set_metadata(openvdb::GridBase& grid, const Units& units, const Standing& standing) {
    if (!units.density.empty()) grid.insertMeta("unit", openvdb::StringMetadata(units.density));
    if (!units.length.empty())
        grid.insertMeta("length_unit", openvdb::StringMetadata(units.length));
    for (const auto& [name, to] : {std::pair{"up", standing.up}, {"front", standing.front}})
        if (to != Vec3d{}) grid.insertMeta(name, openvdb::Vec3DMetadata({to.x, to.y, to.z}));
}

openvdb::FloatGrid::Ptr grid_from_volume(const Volume& volume) {
    using openvdb::FloatGrid;
    using LeafT = FloatGrid::TreeType::LeafNodeType;
    openvdb::initialize();
    const auto grid = openvdb::gridPtrCast<FloatGrid>(
        openvdb::GridBase::createGrid(FloatGrid::gridType()));  // background 0
    grid->setName(volume.name.empty() ? "density" : volume.name);
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    set_metadata(*grid, volume.units, volume.standing);

    set_transform(*grid, volume.world_from_index, volume.source.empty() ? "volume" : volume.source);
    for (const Tile& tile : volume.tiles) {
        grid->tree().addTile(tile_level(tile.edge), to_coord(tile.origin), tile.value, true);
    }
    std::vector<LeafT*> leaves(volume.leaves.size());
    vog::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), kLeavesPerTask),
                      [&](const auto& range) {
                          for (std::size_t i = range.begin(); i < range.end(); ++i) {
                              const Leaf& from = volume.leaves[i];
                              leaves[i] = new LeafT(to_coord(from.origin), 0.0f, false);
                              std::ranges::copy(from.value, leaves[i]->buffer().data());
                              LeafT::NodeMaskType mask;
                              for (openvdb::Index word = 0; word < from.mask.size(); ++word)
                                  mask.template getWord<openvdb::Index64>(word) = from.mask[word];
                              leaves[i]->setValueMask(mask);
                          }
                      });
    for (LeafT* leaf : leaves) grid->tree().addLeaf(leaf);  // the tree owns it
    return grid;
}

}  // namespace vog
