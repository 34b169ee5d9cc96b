// measure_values_test.cpp: a measure's own values as a field, and measures that count voxels.
#include <gtest/gtest.h>

#include "support/voxel_fields.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

using openvdb::Coord;

}  // namespace

TEST_F(voxel_field, a_volumes_own_values) {
    Volume volume = cube_of(8, 0.5f, {});
    volume.name = "ct";
    volume.tiles = {{{8, 0, 0}, 8, 0.25f}};
    const VoxelField field = own_field(volume);
    EXPECT_EQ(field.name, "ct");
    EXPECT_EQ(own_field(volume, "hu").name, "hu");
    EXPECT_EQ(field.component[0].leaf[0], volume.leaves[0].value);
    EXPECT_EQ(field.component[0].tile, std::vector<float>{0.25f});
    EXPECT_EQ(field.lower, 0.25);
    EXPECT_EQ(field.upper, 0.5);
}

/// A measure of volume, for signed values.
TEST_F(voxel_field, ones_count_active_voxels_of_any_value) {
    const auto grid = make_grid("hu", openvdb::GRID_UNKNOWN);
    fill(*grid, {}, {9, 7, 7}, signed_value);
    set_voxel(*grid, {3, 2, 1}, kNan);
    grid->tree().addTile(1, Coord(64, 0, 0), -5, true);
    write_grids(dir_ / "ct.vdb", {grid});
    const VdbOptions ones{.ones = true};
    std::vector<std::string> notes;
    Volume volume = read_volume(dir_ / "ct.vdb", ones, &notes);
    validate(volume);
    EXPECT_EQ(active_voxels(volume), 639u + 512u);
    EXPECT_EQ(mass(volume), 639.0 + 512.0);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("ct.vdb: grid 'hu': 1 value not finite, left out, the first "
                            "at index [3, 2, 1]"),
              std::string::npos)
        << notes[0];
    const VoxelField field = read_field({.file = dir_ / "ct.vdb", .grid = "hu"}, volume);
    EXPECT_EQ(field.lower, double(signed_value({0, 7, 0})));
    EXPECT_EQ(field.component[0].tile, std::vector<float>{-5});
    const std::vector<std::filesystem::path> files{dir_ / "ct.vdb"};
    EXPECT_EQ(mass(read_levels(files, {.ones = true}).volumes[0]), 1151.0);

    const auto count = [&](const openvdb::GridBase::Ptr& other) {
        write_grids(dir_ / "other.vdb", {other});
        return mass(read_volume(dir_ / "other.vdb", {.grid = other->getName(), .ones = true}));
    };
    const auto surface = make_grid("surface", openvdb::GRID_LEVEL_SET);
    fill(*surface, {}, {3, 3, 3}, [](Vec3i i) { return float(i.x) - 1.5f; });
    EXPECT_EQ(count(surface), 64);
    const auto flags = make_grid<openvdb::BoolGrid>("flags");
    flags->tree().setValueOn({0, 0, 0}, false);
    flags->tree().setValueOn({0, 0, 1}, true);
    EXPECT_EQ(count(flags), 2);
    const auto mask = make_grid<openvdb::MaskGrid>("mask");
    mask->tree().setValueOn({3, 0, 0});
    EXPECT_EQ(count(mask), 1);
    const auto velocity = make_grid<openvdb::Vec3SGrid>("v");
    set_voxel(*velocity, {0, 0, 0}, openvdb::Vec3s(-1, 0, 2));
    EXPECT_EQ(count(velocity), 1);
}

}  // namespace vog::test
