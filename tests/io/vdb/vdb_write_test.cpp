// vdb_write_test.cpp: exact round trips of volumes through OpenVDB grids and files.
#include <gtest/gtest.h>

#include "support/data.h"
#include "support/random_volume.h"
#include "support/refused_files.h"
#include "support/vdb_grids.h"
#include "vog/error.h"
#include "vog/openvdb.h"
#include "vog/volume_io.h"

namespace vog {
namespace {

using test::expect_same_volume;
using test::TempDir;

/// Random volume without its leaf that has no active voxel, which readers drop.
Volume sample_volume() {
    Volume volume = test::random_volume(1);
    std::erase_if(volume.leaves, [](const Leaf& leaf) { return leaf.active_count() == 0; });
    volume.leaves[3].set(17, 0);  // active, of value zero
    return volume;
}

TEST(vdb_write, a_volume_comes_back_exactly_through_a_grid_and_through_a_file) {
    const TempDir dir;
    Volume volume = sample_volume();
    auto maps = test::grid_maps();
    maps.push_back({"microns",
                    {{{Vec3d{1e-6, 0, 0}, Vec3d{0, 2e-6, 0}, Vec3d{0, 0, 1e-6}}},
                     {1e3, 0, 0}}});  // OpenVDB's own maps refuse voxels below 1.4e-5
    for (const auto& [name, map] : maps) {
        SCOPED_TRACE(name);
        volume.world_from_index = map;
        expect_same_volume(volume_from_grid(*grid_from_volume(volume)), volume);
        write_vdb(dir / "volume.vdb", volume);
        expect_same_volume(read_vdb(dir / "volume.vdb"), volume);
    }
}

TEST(vdb_write, the_file_is_what_openvdb_calls_a_fog_volume) {
    const TempDir dir;
    Volume volume = sample_volume();
    volume.name = "smoke";
    write_vdb(dir / "volume.vdb", volume);
    openvdb::io::File file((dir / "volume.vdb").string());
    file.open(/*delayLoad=*/false);
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("smoke"));
    ASSERT_TRUE(grid);
    EXPECT_EQ(grid->getGridClass(), openvdb::GRID_FOG_VOLUME);
    EXPECT_EQ(grid->activeVoxelCount(), active_voxels(volume));
    EXPECT_EQ(grid->background(), 0);
    EXPECT_FALSE(grid->saveFloatAsHalf());
    expect_same_volume(volume_from_grid(*grid), volume);
}

TEST(vdb_write, half_floats_are_rounded_once_and_their_range_is_kept) {
    const TempDir dir;
    Volume volume = sample_volume();
    volume.tiles.clear();
    write_vdb(dir / "half.vdb", volume, /*half=*/true);
    EXPECT_TRUE(inspect_vdb(dir / "half.vdb").at(0).half_stored);
    const Volume read = read_vdb(dir / "half.vdb");
    ASSERT_EQ(read.leaves.size(), volume.leaves.size());
    for (std::size_t i = 0; i < read.leaves.size(); ++i) {
        EXPECT_EQ(read.leaves[i].mask, volume.leaves[i].mask);
        for (std::size_t n = 0; n < kLeafVoxels; ++n)  // 11 bits of significand
            EXPECT_NEAR(read.leaves[i].value[n], volume.leaves[i].value[n],
                        volume.leaves[i].value[n] / 2048);
    }
    volume.leaves[0].set(0, 70000);
    EXPECT_NE(test::error_of([&] {
                  write_vdb(dir / "half.vdb", volume, true);
              }).find("density 70000 as half floats, expected at most 65504"),
              std::string::npos);
    expect_same_volume(read_vdb(dir / "half.vdb"), read);  // the file that was there is untouched
}

TEST(vdb_write, equal_volumes_make_equal_files) {
    const TempDir dir;
    write_vdb(dir / "a.vdb", sample_volume());
    write_vdb(dir / "b.vdb", sample_volume());
    EXPECT_EQ(test::read_bytes(dir / "a.vdb"), test::read_bytes(dir / "b.vdb"));
}

TEST(vdb_write, what_cannot_be_written_is_refused) {
    const TempDir dir;
    EXPECT_NE(test::error_of([&] {
                  write_vdb(dir / "a.vdb", Volume{});
              }).find("cannot write: no active voxels"),
              std::string::npos);
    Volume volume = sample_volume();
    EXPECT_NE(test::error_of([&] { write_vdb(dir / "no" / "a.vdb", volume); }).find("no folder"),
              std::string::npos);
    if (std::filesystem::exists("/dev/full")) {
        EXPECT_NE(test::error_of([&] {
                      write_vdb("/dev/full", volume);
                  }).find("/dev/full: cannot write: No space left on device"),
                  std::string::npos);
    }
    volume.leaves[0].value[0] = -1;
    EXPECT_THROW(write_vdb(dir / "a.vdb", volume), Error);
    EXPECT_FALSE(std::filesystem::exists(dir / "a.vdb"));
}

TEST(vdb_write, a_shear_too_small_for_openvdb_is_refused) {
    Volume volume = sample_volume();
    volume.world_from_index.linear = {{Vec3d{1e-6, 1e-7, 0}, Vec3d{0, 1e-6, 0}, Vec3d{0, 0, 1e-6}}};
    EXPECT_NE(test::error_of([&] { grid_from_volume(volume); }).find("nearly singular"),
              std::string::npos);
}

TEST(vdb_write, volume_from_grid_refuses_what_is_no_density) {
    const auto surface = test::varied_grid("surface", openvdb::GRID_LEVEL_SET);
    EXPECT_NE(test::error_of([&] { volume_from_grid(*surface); }).find("a level set"),
              std::string::npos);
    const auto broken = test::varied_grid("broken");
    test::set_voxel(*broken, {1, 1, 1}, std::numeric_limits<float>::infinity());
    EXPECT_NE(test::error_of([&] { volume_from_grid(*broken); })
                  .find("grid 'broken': 1 active values are not finite, the first at index "
                        "[1, 1, 1]"),
              std::string::npos);
    EXPECT_TRUE(volume_from_grid(*test::make_grid("empty")).empty());
}

TEST(vdb_write, several_volumes_are_several_grids_of_one_file) {
    const TempDir dir;
    std::vector<Volume> volumes{sample_volume(), test::random_volume(2)};
    std::erase_if(volumes[1].leaves, [](const Leaf& leaf) { return leaf.active_count() == 0; });
    volumes[0].name = "density_L0", volumes[1].name = "density_L1";
    volumes[1].world_from_index = test::grid_maps()[3].second;
    write_vdb(dir / "levels.vdb", volumes);
    EXPECT_EQ(vdb_grid_names(dir / "levels.vdb"),
              (std::vector<std::string>{"density_L0", "density_L1"}));
    for (const Volume& volume : volumes) {
        SCOPED_TRACE(volume.name);
        expect_same_volume(read_vdb(dir / "levels.vdb", {volume.name}), volume);
    }
    openvdb::io::File file((dir / "levels.vdb").string());
    file.open(/*delayLoad=*/false);
    EXPECT_EQ(file.getGrids()->size(), 2u);

    volumes[1].name = "density_L0";
    EXPECT_THROW(write_vdb(dir / "twice.vdb", volumes), Error);
    EXPECT_THROW(write_vdb(dir / "none.vdb", std::vector<Volume>{}), Error);
    EXPECT_FALSE(std::filesystem::exists(dir / "twice.vdb"));
}

TEST(vdb_write, volumes_stand_as_they_stood) {
    const TempDir dir;
    Volume volume = sample_volume();
    for (const Standing& standing :
         {Standing{}, Standing{{0, 0, 1}, {}}, Standing{{0.6, 0, 0.8}, {0, -1, 0}}}) {
        volume.standing = standing;
        write_vdb(dir / "volume.vdb", volume);
        EXPECT_EQ(read_vdb(dir / "volume.vdb").standing, standing);
    }
}

}  // namespace
}  // namespace vog
