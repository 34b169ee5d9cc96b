// vdb_test.cpp: read_vdb on voxels, tiles, value types, transforms and level sets.
#include "vog/volume_io.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/vdb/vdb_reader.h"
#include "support/data.h"
#include "support/refused_files.h"
#include "support/vdb_grids.h"
#include "vog/openvdb.h"
#include "vog/progress.h"

namespace vog {

using namespace vdb;
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using test::expect_same_volume;
using test::make_grid;
using test::set_voxel;
using test::TempDir;
using test::write_grids;

/// Writes `grids` to a file and reads one of them, whole and in parts.
Volume through_file(const openvdb::GridPtrVec& grids, const VdbOptions& options = {},
                    ValueNotes* notes = nullptr) {
    const TempDir dir;
    write_grids(dir / "grid.vdb", grids);
    const Volume whole = read_vdb(dir / "grid.vdb", options, notes);
    VdbReader reader(dir / "grid.vdb", options);
    for (int n = 0; n < 3; ++n) expect_same_volume(reader.read({n, 3}), part_of(whole, {n, 3}));
    return whole;
}

TEST(vdb, voxels_and_tiles_of_every_level_arrive_as_what_they_are) {
    const Volume volume = through_file({test::varied_grid("density")});
    validate(volume);
    ASSERT_EQ(volume.leaves.size(), 5u);
    EXPECT_EQ(volume.leaves.front().origin, (Vec3i{-8, 200, 0}));
    EXPECT_TRUE(volume.leaves.front().dense());
    EXPECT_EQ(volume.leaves.front().value[511], 511 % 7);
    EXPECT_TRUE(volume.leaves.front().active(0));  // active, of value zero
    for (std::size_t leaf = 1; leaf < 5; ++leaf) {
        EXPECT_EQ(volume.leaves[leaf].active_count(), 6);
        for (int n = 0; n < kLeafVoxels; ++n)  // no inactive value shows
            EXPECT_EQ(volume.leaves[leaf].active(n), volume.leaves[leaf].value[n] != 0);
        EXPECT_EQ(volume.leaves[leaf].value[leaf_offset(4, 0, static_cast<int>(leaf) - 1)], 5);
    }
    ASSERT_EQ(volume.tiles.size(), 3u);  // the inactive one is not among them
    EXPECT_EQ(volume.tiles[0].origin, (Vec3i{-256, 0, 128}));
    EXPECT_EQ(volume.tiles[0].edge, 128);
    EXPECT_EQ(volume.tiles[0].value, 4);
    EXPECT_EQ(volume.tiles[1].edge, 8);
    EXPECT_EQ(volume.tiles[1].value, 3);
    EXPECT_EQ(volume.tiles[2].origin, (Vec3i{4096, -8192, 0}));
    EXPECT_EQ(volume.tiles[2].edge, 4096);
    EXPECT_EQ(volume.tiles[2].value, 5);
    EXPECT_EQ(active_voxels(volume), 512u + 24 + 512 + 128 * 128 * 128 + (1ull << 36));
    EXPECT_EQ(volume.name, "density");
    EXPECT_TRUE(volume.source.ends_with("grid.vdb"));
}

TEST(vdb, every_scalar_type_and_storage_gives_the_same_volume) {
    const TempDir dir;
    const auto file = dir / "grid.vdb";
    const Volume expected = volume_from_grid(*test::varied_grid("density"));
    const auto check = [&](const openvdb::GridBase::Ptr& grid) {
        // Zip is used for grids of class unknown only.
        for (const auto kind : {openvdb::GRID_FOG_VOLUME, openvdb::GRID_UNKNOWN})
            for (const bool half : {false, true})
                for (std::uint32_t compression = 0; compression < 8; ++compression) {
                    SCOPED_TRACE(grid->type() + (half ? " half " : " ") +
                                 openvdb::io::compressionToString(compression));
                    grid->setGridClass(kind);
                    grid->setSaveFloatAsHalf(half);
                    write_grids(file, {grid}, compression);
                    expect_same_volume(read_vdb(file), expected);
                    // Integers below 2048 are exact as half floats.
                }
    };
    check(test::varied_grid<FloatGrid>("density"));
    check(test::varied_grid<openvdb::DoubleGrid>("density"));
    check(test::varied_grid<openvdb::Int32Grid>("density"));
    check(test::varied_grid<openvdb::Int64Grid>("density"));
}

TEST(vdb, vectors_are_read_by_magnitude) {
    const auto grid = make_grid<openvdb::Vec3SGrid>("velocity");
    set_voxel(*grid, {1, 2, 3}, openvdb::Vec3s(2, -3, 6));
    grid->tree().addTile(1, Coord(8, 0, 0), openvdb::Vec3s(0, -4, 3), true);
    const Volume volume = through_file({grid}, {.grid = "velocity"});
    ASSERT_EQ(volume.leaves.size(), 1u);
    EXPECT_EQ(volume.leaves[0].value[leaf_offset(1, 2, 3)], 7);
    ASSERT_EQ(volume.tiles.size(), 1u);
    EXPECT_EQ(volume.tiles[0].value, 5);
}

TEST(vdb, leaves_without_active_voxels_are_dropped) {
    const auto grid = make_grid("density");
    set_voxel(*grid, {0, 0, 0}, 1);
    grid->tree().setValueOff({100, 0, 0}, 7);
    EXPECT_EQ(grid->tree().leafCount(), 2u);
    EXPECT_EQ(through_file({grid}).leaves.size(), 1u);
}

TEST(vdb, negative_values_are_refused_or_become_zero_and_are_counted) {
    const auto grid = make_grid("density");
    for (int i = 0; i < 20; ++i) set_voxel(*grid, {i, 0, 0}, static_cast<float>(i - 5));
    grid->tree().addTile(1, Coord(0, 64, 0), -1, true);
    ValueNotes notes;
    const std::string message = test::error_of([&] { through_file({grid}); });
    EXPECT_NE(message.find("6 active values are negative, the first at index [0, 0, 0]"),
              std::string::npos)
        << message;
    EXPECT_NE(message.find("--clip-negative"), std::string::npos) << message;
    VdbOptions clip;
    clip.values.clip_negative = true;
    const Volume volume = through_file({grid}, clip, &notes);
    EXPECT_EQ(notes.clipped_negative, 5u + 1u);  // a tile is one value
    EXPECT_EQ(active_voxels(volume), 20u + 512u);
    EXPECT_EQ(volume.tiles[0].value, 0);
    EXPECT_EQ(volume.leaves[0].value[leaf_offset(4, 0, 0)], 0);
    EXPECT_EQ(volume.leaves[0].value[leaf_offset(6, 0, 0)], 1);
}

TEST(vdb, values_that_are_not_finite_are_refused_with_count_and_first_index) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto grid = make_grid("density");
    set_voxel(*grid, {-20, 3, 4}, std::numeric_limits<float>::infinity());
    set_voxel(*grid, {-20, 3, 5}, nan);
    set_voxel(*grid, {40, 3, 4}, nan);
    grid->tree().addTile(1, Coord(-64, 0, 0), nan, true);
    grid->tree().setValueOff({-70, 0, 0}, nan);  // inactive: does not count
    const std::string message = test::error_of([&] { through_file({grid}); });
    EXPECT_NE(message.find("4 active values are not finite, the first at index [-20, 3, 4]"),
              std::string::npos)
        << message;
    EXPECT_NE(message.find("grid.vdb: grid 'density'"), std::string::npos) << message;

    VdbOptions skip;
    skip.values.skip_nonfinite = true;
    set_voxel(*grid, {0, 0, 0}, 3);
    grid->tree().setValueOff({0, 0, 1}, nan);
    ValueNotes notes;
    const Volume volume = through_file({grid}, skip, &notes);
    EXPECT_EQ(notes.skipped_nonfinite, 4u);
    EXPECT_EQ(notes.inactive_nonfinite, 1u);
    EXPECT_EQ(active_voxels(volume), 1u) << "voxels and tiles without a value are inactive";
    EXPECT_EQ(volume.leaves.size(), 1u);
    EXPECT_NO_THROW(validate(volume));
    EXPECT_EQ(values_text(notes, "a.vdb"),
              "a.vdb: 4 values not finite, left out, the first at index [-20, 3, 4]; 1 "
              "inactive voxel with a value not finite: empty space");

    const auto large = make_grid<openvdb::DoubleGrid>("density");
    set_voxel(*large, {0, 0, 0}, 1e300);  // finite, but no float
    EXPECT_NE(test::error_of([&] { through_file({large}); }).find("1 active values"),
              std::string::npos);
}

/// Level set of a sphere of radius 20 voxels, with a narrow band of 3 on each side and a central
/// tile.
template <class GridT>
typename GridT::Ptr sphere(double& radius, double& band) {
    radius = 20;
    band = 3;
    const auto grid = make_grid<GridT>("surface", openvdb::GRID_LEVEL_SET);
    auto& tree = grid->tree();
    tree.root().setBackground(static_cast<typename GridT::ValueType>(band), true);
    for (int x = -24; x <= 24; ++x)
        for (int y = -24; y <= 24; ++y)
            for (int z = -24; z <= 24; ++z) {
                const double d = std::sqrt(x * x + y * y + z * z) - radius;
                const auto value = static_cast<typename GridT::ValueType>(d);
                if (std::abs(d) < band)
                    tree.setValueOn({x, y, z}, value);
                else if (d < 0)
                    tree.setValueOff({x, y, z}, static_cast<typename GridT::ValueType>(-band));
            }
    tree.addTile(1, Coord(0, 0, 0), static_cast<typename GridT::ValueType>(-band), false);
    return grid;
}

template <class GridT>
void expect_fog() {
    double radius, band;
    const auto grid = sphere<GridT>(radius, band);
    const std::string message = test::error_of([&] { through_file({grid}); });
    EXPECT_NE(message.find("a level set, expected density (--level-set-to-fog converts it)"),
              std::string::npos)
        << message;

    const Volume volume = through_file({grid}, {.level_set_to_fog = true});
    validate(volume);
    ASSERT_EQ(volume.tiles.size(), 1u);
    EXPECT_EQ(volume.tiles[0].value, 1);
    std::uint64_t inside = 0;
    for (const Leaf& leaf : volume.leaves)
        for (int n = 0; n < kLeafVoxels; ++n) {
            const Vec3i i = leaf.origin + Vec3i{n >> 6, (n >> 3) & 7, n & 7};
            const double d = std::sqrt(i.x * i.x + i.y * i.y + i.z * i.z) - radius;
            EXPECT_EQ(leaf.active(n), d < 0);
            inside += d < 0;
            // One rounding of the distance and two of the ramp, in float: 3 * 2^-24, rounded up.
            EXPECT_NEAR(leaf.value[n], std::clamp(-d / band, 0.0, 1.0), 4e-7);
        }
    EXPECT_EQ(inside + 512, active_voxels(volume));
    EXPECT_GT(inside, 30000u);  // 4/3 pi 20^3 = 33510, less the tile
}

TEST(vdb, a_level_set_is_refused_but_its_inside_can_be_taken_as_fog) {
    expect_fog<FloatGrid>();
    expect_fog<openvdb::DoubleGrid>();
}

TEST(vdb, level_set_to_fog_refuses_what_is_no_level_set) {
    const auto fog = make_grid("density");
    set_voxel(*fog, {0, 0, 0}, 1);
    EXPECT_NE(test::error_of([&] {
                  through_file({fog}, {.level_set_to_fog = true});
              }).find("class fog volume, expected a level set"),
              std::string::npos);
    double radius, band;
    const auto grid = sphere<FloatGrid>(radius, band);
    set_voxel(*grid, {20, 0, 0}, std::numeric_limits<float>::quiet_NaN());
    EXPECT_NE(test::error_of([&] {
                  through_file({grid}, {.level_set_to_fog = true});
              }).find("not finite, the first at index [20, 0, 0]"),
              std::string::npos);
}

TEST(vdb, real_data_have_the_same_bytes_for_any_number_of_threads) {
    VOG_NEEDS_DATA("cloud.vdb");
    const Volume parallel = read_vdb(test::data_dir() / "cloud.vdb");
    for (const int threads : {1, 2, 3}) {
        const ThreadLimit limit(threads);
        expect_same_volume(read_vdb(test::data_dir() / "cloud.vdb"), parallel);
    }
}

TEST(vdb, real_data_have_the_active_voxels_they_are_known_for) {
    VOG_NEEDS_DATA("smoke.vdb");
    const auto count = [](const char* name, const char* grid = "") {
        const Volume volume = read_vdb(test::data_dir() / name, {.grid = grid});
        validate(volume);
        return active_voxels(volume);  // tiles included
    };
    EXPECT_EQ(count("smoke.vdb"), 1049275u);
    EXPECT_EQ(count("cloud.vdb"), 415642u);
    EXPECT_EQ(count("fire.vdb", "flames"), 149814u);
    EXPECT_EQ(count("fire.vdb", "temperature"), 412789u);
    EXPECT_EQ(count("aquarius.vdb"), 1263242u);
    EXPECT_EQ(count("enzo/level1.vdb"), 57696u);
    EXPECT_EQ(read_vdb(test::data_dir() / "smoke.vdb").leaves.size(), 3117u);
    EXPECT_EQ(read_vdb(test::data_dir() / "cloud.vdb").tiles.size(), 130u);
}

}  // namespace
}  // namespace vog
