// vdb_info_test.cpp: inspect_vdb on grids of every kind.
#include <gtest/gtest.h>
#include <openvdb/points/PointConversion.h>

#include "support/data.h"
#include "support/refused_files.h"
#include "support/vdb_grids.h"
#include "vog/volume_io.h"

namespace vog {
namespace {

using test::make_grid;
using test::set_voxel;
using test::TempDir;
using test::write_grids;

std::vector<GridInfo> info_of(const openvdb::GridPtrVec& grids) {
    const TempDir dir;
    write_grids(dir / "grids.vdb", grids);
    return inspect_vdb(dir / "grids.vdb");
}

/// Time in proportion to their number: OpenVDB's iterators of values count them again for each.
TEST(vdb_info, tens_of_thousands_of_root_tiles_are_listed_and_read) {
    const auto grid = test::make_grid("density");
    constexpr int kAcross = 40;
    for (int n = 0; n < kAcross * kAcross * kAcross; ++n)
        grid->tree().addTile(3,
                             openvdb::Coord(4096 * (n / (kAcross * kAcross)),
                                            4096 * (n / kAcross % kAcross), 4096 * (n % kAcross)),
                             1 + static_cast<float>(n % 3), true);
    const test::TempDir dir;
    test::write_grids(dir / "tiles.vdb", {grid});
    const GridInfo info = inspect_vdb(dir / "tiles.vdb").front();
    EXPECT_EQ(info.active_tiles[2], 64000u);
    EXPECT_EQ(info.max, 3);
    const Volume volume = read_vdb(dir / "tiles.vdb");
    ASSERT_EQ(volume.tiles.size(), 64000u);
    EXPECT_EQ(volume.tiles[1].origin, (Vec3i{0, 0, 4096}));
    EXPECT_EQ(volume.tiles[1].edge, 4096);
    EXPECT_EQ(volume.tiles[1].value, 2);
}

TEST(vdb_info, counts_voxels_tiles_and_leaves) {
    const auto grid = test::varied_grid("density");
    const auto info = info_of({grid}).at(0);
    EXPECT_EQ(info.name, "density");
    EXPECT_EQ(info.type, "float");
    EXPECT_EQ(info.grid_class, "fog volume");
    EXPECT_FALSE(info.half_stored);
    EXPECT_EQ(info.active_voxels, 512u + 24 + 512 + 128 * 128 * 128 + (1ull << 36));
    EXPECT_EQ(info.active_tiles, (std::array<std::uint64_t, 3>{1, 1, 1}));
    EXPECT_EQ(info.leaves, 5u);
    EXPECT_EQ(info.dense_leaves, 1u);
    EXPECT_EQ(info.points, 0u);
    EXPECT_EQ(info.lower, (Vec3i{-256, -8192, 0}));
    EXPECT_EQ(info.upper, (Vec3i{8191, 207, 4095}));
    EXPECT_EQ(info.min, 0);
    EXPECT_EQ(info.max, 21);
    EXPECT_EQ(info.memory_bytes, grid->memUsage());
    EXPECT_TRUE(info.affine);
}

TEST(vdb_info, the_world_box_has_voxel_faces_and_follows_the_transform) {
    const auto grid = make_grid("density");
    set_voxel(*grid, {1, 2, 3}, 1);
    set_voxel(*grid, {4, 2, 3}, 1);
    const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    transform->preScale(openvdb::Vec3d(2, 0.5, -1));
    transform->postTranslate({10, 0, 0});
    grid->setTransform(transform);
    const auto info = info_of({grid}).at(0);
    EXPECT_EQ(info.world.lower, (Vec3d{10 + 2 * 0.5, 0.5 * 1.5, -3.5}));
    EXPECT_EQ(info.world.upper, (Vec3d{10 + 2 * 4.5, 0.5 * 2.5, -2.5}));
    EXPECT_EQ(info.world_from_index.translation, (Vec3d{10, 0, 0}));
}

TEST(vdb_info, every_kind_of_grid_is_told_in_file_order) {
    const auto vectors = make_grid<openvdb::Vec3DGrid>("velocity", openvdb::GRID_STAGGERED);
    set_voxel(*vectors, {0, 0, 0}, {3, -4, 0});
    set_voxel(*vectors, {1, 0, 0}, {0, 0, -2});
    const auto mask = make_grid<openvdb::MaskGrid>("mask");
    set_voxel(*mask, {0, 0, 0}, true);
    const auto flags = make_grid<openvdb::BoolGrid>("flags");
    set_voxel(*flags, {0, 0, 0}, true);
    set_voxel(*flags, {9, 0, 0}, false);
    const auto numbers = make_grid<openvdb::Int64Grid>("numbers", openvdb::GRID_UNKNOWN);
    set_voxel(*numbers, {0, 0, 0}, -7);
    const auto half = make_grid("half");
    half->setSaveFloatAsHalf(true);
    const auto shell = make_grid("shell", openvdb::GRID_LEVEL_SET);
    set_voxel(*shell, {0, 0, 0}, -0.5f);
    const auto frustum = make_grid("frustum");
    set_voxel(*frustum, {0, 0, 0}, 1);
    frustum->setTransform(openvdb::math::Transform::createFrustumTransform(
        openvdb::BBoxd({0, 0, 0}, {10, 10, 10}), 0.5, 10, 1));

    const auto infos = info_of({vectors, mask, flags, numbers, half, shell, frustum});
    ASSERT_EQ(infos.size(), 7u);
    EXPECT_EQ(infos[0].type, "vec3d");
    EXPECT_EQ(infos[0].grid_class, "staggered");
    EXPECT_EQ(infos[0].min, 2);  // magnitudes
    EXPECT_EQ(infos[0].max, 5);
    EXPECT_EQ(infos[1].type, "mask");
    EXPECT_EQ(infos[1].active_voxels, 1u);
    EXPECT_EQ(infos[2].type, "bool");
    EXPECT_EQ(infos[2].leaves, 2u);
    EXPECT_EQ(infos[2].min, 0);
    EXPECT_EQ(infos[2].max, 1);
    EXPECT_EQ(infos[3].type, "int64");
    EXPECT_EQ(infos[3].grid_class, "unknown");
    EXPECT_EQ(infos[3].min, -7);
    EXPECT_TRUE(infos[4].half_stored);
    EXPECT_EQ(infos[4].active_voxels, 0u);
    EXPECT_TRUE(infos[4].world.empty());
    EXPECT_EQ(infos[5].grid_class, "level set");
    EXPECT_FALSE(infos[6].affine);
    EXPECT_EQ(infos[6].active_voxels, 1u);
}

TEST(vdb_info, points_are_counted_but_are_no_density) {
    using namespace openvdb::points;
    openvdb::initialize();
    std::vector<openvdb::Vec3s> positions;
    for (int i = 0; i < 1000; ++i)
        positions.emplace_back(static_cast<float>(i % 10), static_cast<float>(i / 10 % 10),
                               static_cast<float>(i / 100) + 0.01f * static_cast<float>(i % 7));
    const auto transform = openvdb::math::Transform::createLinearTransform(0.5);
    const auto grid = createPointDataGrid<NullCodec, PointDataGrid>(positions, *transform);
    grid->setName("particles");
    const TempDir dir;
    write_grids(dir / "points.vdb", {grid});

    const auto info = inspect_vdb(dir / "points.vdb").at(0);
    EXPECT_EQ(info.name, "particles");
    EXPECT_EQ(info.type, "points");
    EXPECT_EQ(info.points, 1000u);
    EXPECT_EQ(info.active_voxels, grid->activeVoxelCount());
    EXPECT_EQ(info.leaves, grid->tree().leafCount());
    EXPECT_EQ(info.world_from_index.linear(0, 0), 0.5);
    EXPECT_GT(info.memory_bytes, 1000 * sizeof(openvdb::Vec3s));
    EXPECT_NE(test::error_of([&] { read_vdb(dir / "points.vdb", {.grid = "particles"}); })
                  .find("grid 'particles': holds points, expected float, double, int32, int64, "
                        "bool, mask or vec3"),
              std::string::npos);
    EXPECT_NE(test::error_of([&] { read_vdb(dir / "points.vdb"); }).find("no scalar grid"),
              std::string::npos);
}

TEST(vdb_info, a_grid_of_an_unknown_type_does_not_hide_the_others) {
    const auto grid = make_grid("density");
    set_voxel(*grid, {0, 0, 0}, 1);
    const auto other = make_grid<openvdb::Int32Grid>("odd");
    const TempDir dir;
    write_grids(dir / "a.vdb", {other, grid});
    std::string bytes = test::read_bytes(dir / "a.vdb");
    bytes.replace(bytes.find("Tree_int32"), 10, "Tree_qua32");
    test::write_bytes(dir / "a.vdb", bytes);
    const auto infos = inspect_vdb(dir / "a.vdb");
    ASSERT_EQ(infos.size(), 2u);
    EXPECT_EQ(infos[0].type, "qua32");
    EXPECT_EQ(infos[0].grid_class, "fog volume");
    EXPECT_EQ(infos[1].active_voxels, 1u);
    EXPECT_EQ(active_voxels(read_vdb(dir / "a.vdb")), 1u);
    EXPECT_THROW(read_vdb(dir / "a.vdb", {.grid = "odd"}), Error);
}

TEST(vdb_info, real_data) {
    VOG_NEEDS_DATA("smoke.vdb");
    const auto smoke = inspect_vdb(test::data_dir() / "smoke.vdb").at(0);
    EXPECT_EQ(smoke.active_voxels, 1049275u);
    EXPECT_EQ(smoke.leaves, 3117u);
    EXPECT_EQ(smoke.dense_leaves, 353u);
    EXPECT_TRUE(smoke.half_stored);
    EXPECT_EQ(smoke.lower, (Vec3i{1, 2, 1}));
    EXPECT_EQ(smoke.upper, (Vec3i{111, 223, 112}));
    const auto cloud = inspect_vdb(test::data_dir() / "cloud.vdb").at(0);
    EXPECT_EQ(cloud.active_tiles, (std::array<std::uint64_t, 3>{130, 0, 0}));
    EXPECT_EQ(cloud.active_voxels, 415642u);  // tiles included
}

}  // namespace
}  // namespace vog
