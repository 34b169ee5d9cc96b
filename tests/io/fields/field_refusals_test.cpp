// field_refusals_test.cpp: fields that are not finite, lie elsewhere, or are not there.
#include <gtest/gtest.h>

#include "support/voxel_fields.h"
#include "vog/points.h"

namespace vog::test {

namespace {

using openvdb::Coord;

}  // namespace

TEST_F(voxel_field, values_not_finite_count_at_voxels_of_the_measure_alone) {
    Volume volume = cube_of(8, 0.5f, {});
    const auto grid = make_grid("t");
    fill(*grid, {-4, -4, -4}, {12, 12, 12}, [](Vec3i) { return 1.0f; });
    set_voxel(*grid, {-1, 3, 3}, kNan);
    set_voxel(*grid, {8, 3, 3}, std::numeric_limits<float>::infinity());
    expect_values(
        volume, read(grid, volume), [](Vec3i) { return Vec3d{1}; }, 0);
    // A lattice of half the voxels' size: all centres are those of voxels of the grid.
    Affine fine;
    fine.linear = {{Vec3d{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}};
    place(*grid, fine);
    Volume small = cube_of(4, 0.5f, {});
    set_voxel(*grid, {1, 2, 2}, kNan);
    expect_values(
        small, read(grid, small), [](Vec3i) { return Vec3d{1}; }, 0);
    place(*grid, {});
    set_voxel(*grid, {5, 6, 7}, kNan);
    EXPECT_NE(refusal(grid, volume)
                  .find("grid 't': not finite at 2 voxels of the volume, the "
                        "first at index [1, 2, 2], expected finite values there"),
              std::string::npos);
    const auto large = make_grid<openvdb::DoubleGrid>("t");
    fill(*large, {}, {7, 7, 7}, [](Vec3i) { return 1e300; });
    EXPECT_NE(refusal(large, volume).find("not finite at 512 voxels"), std::string::npos);
    Volume tile;
    tile.tiles = {{{0, 0, 0}, 128, 1}};
    const auto nan_tile = make_grid("t");
    nan_tile->tree().addTile(2, Coord(0, 0, 0), kNan, true);
    EXPECT_NE(refusal(nan_tile, tile).find("not finite at 2,097,152 voxels"), std::string::npos);
}

TEST_F(voxel_field, a_grid_elsewhere_is_refused) {
    Volume volume = cube_of(8, 0.5f, kWorld);
    volume.name = "density";
    const auto grid = make_grid("t");
    set_voxel(*grid, {0, 0, 0}, 1.0f);
    EXPECT_NE(refusal(grid, volume)
                  .find("grid 't': active at no voxel of 'density': [-0.5, -0.5, "
                        "-0.5] to [0.5, 0.5, 0.5] of the world, which lies in "
                        "[100, -7.25, 2.75] to [104, -3.25, 6.75]; expected "
                        "grids that overlap"),
              std::string::npos);
    // Indices beyond the range of integers.
    Affine tiny;
    tiny.linear(0, 0) = 1e-8;
    place(*grid, tiny);
    Volume far = cube_of(8, 0.5f, kWorld);
    far.tiles = {{{128, 0, 0}, 128, 1}};
    EXPECT_NE(refusal(grid, far).find("active at no voxel"), std::string::npos);
}

TEST_F(voxel_field, names_units_and_wrong_grids) {
    Volume volume = cube_of(8, 0.5f, {});
    const auto grid = make_grid("t");
    fill(*grid, {}, {7, 7, 7}, signed_value);
    grid->insertMeta("units", openvdb::StringMetadata("K"));
    EXPECT_EQ(read(grid, volume).unit, "K");
    const VoxelField named = read(grid, volume, {}, {.name = "temperature", .unit = "mK"});
    EXPECT_EQ(named.name, "temperature");
    EXPECT_EQ(named.unit, "mK");
    EXPECT_NE(error_of([&] {
                  read(grid, volume, {}, {.grid = "heat"});
              }).find("fields.vdb: no grid named 'heat' (it has: t)"),
              std::string::npos);
    EXPECT_NE(error_of([&] {
                  read_field({.file = dir_ / "absent.vdb"}, volume);
              }).find("absent.vdb: no such file"),
              std::string::npos);
    EXPECT_EQ(error_of([&] { read_field({.grid = "t"}, volume); }),
              "field 't': no file, expected a .vdb, .nvdb or dense image");
    Points points;
    points.position = {{1, 2, 3}};
    write_points(dir_ / "points.vdb", points);
    EXPECT_NE(error_of([&] {
                  read_field({.file = dir_ / "points.vdb", .grid = "points"}, volume);
              }).find("grid 'points': holds points, expected numbers or vectors"),
              std::string::npos);
}

}  // namespace vog::test
