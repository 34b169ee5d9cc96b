// field_tiles_test.cpp: tiles of a measure inside which a field varies.
#include <gtest/gtest.h>

#include "support/voxel_fields.h"

namespace vog::test {

namespace {

using openvdb::Coord;

}  // namespace

TEST_F(voxel_field, tiles_are_divided_where_the_field_varies) {
    Volume volume = cube_of(8, 0.5f, {});
    volume.tiles = {{{8, 0, 0}, 8, 0.25f}, {{128, 0, 0}, 128, 1.5f}, {{256, 0, 0}, 128, 2}};
    sort_nodes(volume);
    const Volume before = volume;
    std::vector<VoxelField> others{own_field(volume)};

    const auto grid = make_grid("t");
    fill(*grid, {}, {15, 7, 7}, signed_value);           // a leaf and the small tile
    grid->tree().addTile(2, Coord(128, 0, 0), 7, true);  // the first of 128
    set_voxel(*grid, {256, 0, 8}, -2.5f);                // one voxel in the other
    const VoxelField field = read(grid, volume, others);
    validate(volume);
    EXPECT_EQ(active_voxels(volume), active_voxels(before));
    EXPECT_DOUBLE_EQ(mass(volume), mass(before));
    ASSERT_EQ(volume.leaves.size(), 3u);
    EXPECT_EQ(volume.leaves[1].origin, (Vec3i{8, 0, 0}));
    EXPECT_EQ(volume.leaves[2].origin, (Vec3i{256, 0, 8}));
    ASSERT_EQ(volume.tiles.size(), 1u + 16 * 16 * 16 - 1);
    EXPECT_EQ(volume.tiles[0].edge, 128);
    for (std::size_t n = 0; n < volume.tiles.size(); ++n) {
        EXPECT_EQ(field.component[0].tile[n], n == 0 ? 7.0f : 0.0f);
        EXPECT_EQ(volume.tiles[n].value, n == 0 ? 1.5f : 2.0f);
        EXPECT_EQ(others[0].component[0].tile[n], volume.tiles[n].value);
    }
    expect_values(
        volume, field,
        [](Vec3i i) {
            return Vec3d{i.x < 16 ? double(signed_value(i)) : i == Vec3i{256, 0, 8} ? -2.5 : 0.0};
        },
        0);
    expect_values(
        volume, others[0], [](Vec3i i) { return Vec3d{i.x < 8    ? 0.5
                                                      : i.x < 16 ? 0.25
                                                                 : 2.0}; }, 0);
    EXPECT_EQ(notes_.size(), 1u);
    // A second field of the same kind divides nothing more.
    const Volume divided = volume;
    read(grid, volume, others);
    expect_same_volume(volume, divided);
}

/// Takes no quadratic time: 50,000 tiles in the volume and in the grid.
TEST_F(voxel_field, many_tiles_are_sampled_one_by_one) {
    Volume volume;
    const auto grid = make_grid("t");
    for (int n = 0; n < 50000; ++n) {
        const Vec3i origin{4096 * (n / 500), 4096 * (n % 500), 0};
        volume.tiles.push_back({origin, 4096, 0.5f});
        grid->tree().addTile(3, Coord(origin.x, origin.y, origin.z), float(n) - 7, true);
    }
    const VoxelField field = read(grid, volume);
    ASSERT_EQ(volume.tiles.size(), 50000u);
    for (std::size_t n = 0; n < 50000; ++n) ASSERT_EQ(field.component[0].tile[n], float(n) - 7);
    EXPECT_TRUE(notes_.empty());
    // Tiles of many root cells: a grid of voxels a hundredth as large.
    Volume few;
    few.tiles = {{{0, 0, 0}, 4096, 0.5f}};
    Affine fine;
    fine.linear = {{Vec3d{0.01, 0, 0}, {0, 0.01, 0}, {0, 0, 0.01}}};
    const auto corner = make_grid("t");
    corner->tree().addTile(3, Coord(0, 0, 0), 3, true);
    place(*corner, fine);
    read(corner, few);
    EXPECT_EQ(active_voxels(few), std::uint64_t{4096} * 4096 * 4096);
    EXPECT_GT(few.tiles.size(), 32768u);
    EXPECT_EQ(notes_.size(), 1u);
}

TEST_F(voxel_field, tiles_that_would_fill_memory_are_refused) {
    Volume volume;
    volume.tiles = {{{0, 0, 0}, 4096, 0.5f}};
    const auto grid = make_grid("t");
    fill(*grid, {}, {40, 40, 40}, signed_value);
    Affine coarse;
    coarse.linear = {{Vec3d{100, 0, 0}, {0, 100, 0}, {0, 0, 100}}};
    place(*grid, coarse);
    EXPECT_NE(refusal(grid, volume)
                  .find("varies inside the tiles of the volume: more than 268,435,456 voxels or "
                        "16,777,216 tiles to divide them into"),
              std::string::npos);
}

}  // namespace vog::test
