// vdb_grids.h: OpenVDB grids for tests, and files written by OpenVDB.
#pragma once

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <filesystem>
#include <string>

#include "vog/volume.h"

namespace vog::test {

/// Empty grid from OpenVDB's registry: naming a grid type's constructor compiles the whole class.
template <class GridT = openvdb::FloatGrid>
typename GridT::Ptr make_grid(const std::string& name,
                              openvdb::GridClass kind = openvdb::GRID_FOG_VOLUME) {
    openvdb::initialize();
    const auto grid = openvdb::gridPtrCast<GridT>(openvdb::GridBase::createGrid(GridT::gridType()));
    grid->setName(name);
    grid->setGridClass(kind);
    return grid;
}

/// Sets one active voxel.
template <class GridT>
void set_voxel(GridT& grid, openvdb::Coord index, const typename GridT::ValueType& value) {
    grid.tree().setValueOn(index, value);
}

inline constexpr std::uint32_t kDefaultCompression =
    openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK;

inline void write_grids(const std::filesystem::path& file, const openvdb::GridPtrVec& grids,
                        std::uint32_t compression = kDefaultCompression) {
    openvdb::io::File out(file.string());
    out.setCompression(compression);
    out.write(grids);
}

/// Grid with voxels and tiles of every level, and inactive values of every kind of the format.
template <class GridT = openvdb::FloatGrid>
typename GridT::Ptr varied_grid(const std::string& name,
                                openvdb::GridClass kind = openvdb::GRID_FOG_VOLUME) {
    using Value = typename GridT::ValueType;
    const auto grid = make_grid<GridT>(name, kind);
    auto& tree = grid->tree();
    const auto number = [](int n) { return Value(static_cast<float>(n)); };
    // Leaves with 0, 1, 2 and 3 different inactive values beside the background.
    for (int leaf = 0; leaf < 4; ++leaf)
        for (int n = 0; n < 24; ++n) {
            const openvdb::Coord index(8 * leaf + n % 8, n / 8, leaf);
            if (n % 4 == 0)
                tree.setValueOn(index, number(n + 1));
            else if (n % 4 <= leaf)
                tree.setValueOff(index, number(100 + n % 4));
        }
    for (int n = 0; n < 512; ++n)  // a dense leaf, far from the others
        tree.setValueOn({-8 + (n >> 6), 200 + ((n >> 3) & 7), n & 7}, number(n % 7));
    tree.addTile(1, openvdb::Coord(64, 64, 64), number(3), true);
    tree.addTile(1, openvdb::Coord(72, 64, 64), number(9), false);
    tree.addTile(2, openvdb::Coord(-256, 0, 128), number(4), true);
    tree.addTile(3, openvdb::Coord(4096, -8192, 0), number(5), true);
    return grid;
}

/// Expects bitwise equal leaves, tiles and transforms.
inline void expect_same_volume(const Volume& a, const Volume& b) {
    ASSERT_EQ(a.leaves.size(), b.leaves.size());
    for (std::size_t i = 0; i < a.leaves.size(); ++i) {
        EXPECT_EQ(a.leaves[i].origin, b.leaves[i].origin);
        EXPECT_EQ(a.leaves[i].mask, b.leaves[i].mask);
        EXPECT_EQ(a.leaves[i].value, b.leaves[i].value);
    }
    ASSERT_EQ(a.tiles.size(), b.tiles.size());
    for (std::size_t i = 0; i < a.tiles.size(); ++i) {
        EXPECT_EQ(a.tiles[i].origin, b.tiles[i].origin);
        EXPECT_EQ(a.tiles[i].edge, b.tiles[i].edge);
        EXPECT_EQ(a.tiles[i].value, b.tiles[i].value);
    }
    EXPECT_EQ(a.world_from_index, b.world_from_index);
}

}  // namespace vog::test
