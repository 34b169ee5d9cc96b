// vdb_choice_test.cpp: choice of the grid, accepted transforms, and error messages of read_vdb.
#include <gtest/gtest.h>
#include <openvdb/io/Stream.h>

#include <fstream>

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

template <class GridT = openvdb::FloatGrid>
openvdb::GridBase::Ptr grid_with(const std::string& name, float value = 1) {
    const auto grid = make_grid<GridT>(name);
    set_voxel(*grid, {0, 0, 0}, typename GridT::ValueType(value));
    return grid;
}

float first_value(const Volume& volume) { return volume.leaves.at(0).value[0]; }

/// Expects reading to fail with the file's name and exactly this message.
void expect_message(const openvdb::GridPtrVec& grids, const std::string& message,
                    const VdbOptions& options = {}) {
    const TempDir dir;
    const auto file = dir / "grids.vdb";
    write_grids(file, grids);
    EXPECT_EQ(test::error_of([&] { read_vdb(file, options); }), file.string() + message);
}

TEST(vdb_choice, the_only_scalar_grid_is_read) {
    const TempDir dir;
    write_grids(dir / "a.vdb", {grid_with<openvdb::Vec3SGrid>("v"), grid_with("smoke", 3),
                                grid_with<openvdb::BoolGrid>("mask")});
    const Volume volume = read_vdb(dir / "a.vdb");
    EXPECT_EQ(volume.name, "smoke");
    EXPECT_EQ(first_value(volume), 3);
}

TEST(vdb_choice, among_several_scalar_grids_density_is_read) {
    const TempDir dir;
    write_grids(dir / "a.vdb", {grid_with("temperature", 1), grid_with("density", 2)});
    EXPECT_EQ(read_vdb(dir / "a.vdb").name, "density");
    EXPECT_EQ(first_value(read_vdb(dir / "a.vdb", {.grid = "temperature"})), 1);
}

/// Names of the grids that are read by default, with the notes.
struct Default {
    std::vector<std::string> names, notes;
};
Default default_of(const std::filesystem::path& file, const LevelOptions& options = {}) {
    Default found;
    for (const Volume& volume : read_levels(std::span(&file, 1), options, &found.notes).volumes)
        found.names.push_back(volume.name);
    EXPECT_EQ(options.level_set_to_fog ? found.names.front() : read_volume(file).name,
              found.names.back());
    return found;
}

TEST(vdb_choice, without_density_the_largest_fog_volume_is_read_and_noted) {
    const TempDir dir;
    const auto file = dir / "fire.vdb";
    const auto flames = grid_with("flames"), temperature = grid_with("temperature", 2);
    openvdb::gridPtrCast<openvdb::FloatGrid>(temperature)->tree().addTile(1, {8, 0, 0}, 1, true);
    const auto surface = make_grid<openvdb::FloatGrid>("surface");
    surface->tree().addTile(2, {0, 0, 0}, 1, true);
    surface->setGridClass(openvdb::GRID_LEVEL_SET);
    write_grids(file, {flames, temperature, surface, make_grid("empty")});
    const Default found = default_of(file);
    EXPECT_EQ(found.names, std::vector<std::string>{"temperature"});
    EXPECT_EQ(found.notes,
              std::vector<std::string>{
                  file.string() + ": reading 'temperature', the largest of 4 grids; --grid chooses "
                                  "another: flames, surface, empty"});
    EXPECT_EQ(test::error_of([&] { read_volume(file, {.refuse_several = true}); }),
              file.string() +
                  ": 4 grids; choose one with --grid (it has: flames, "
                  "temperature, surface, empty)");
    std::vector<std::string> notes;
    EXPECT_EQ(read_volume(file, {.grid = "flames", .refuse_several = true}, &notes).name, "flames");
    EXPECT_TRUE(notes.empty()) << "a named grid is no guess";
}

TEST(vdb_choice, an_empty_density_gives_way_and_a_full_one_is_not_noted) {
    const TempDir dir;
    write_grids(dir / "a.vdb", {make_grid("density"), grid_with("flames")});
    EXPECT_EQ(default_of(dir / "a.vdb").names, std::vector<std::string>{"flames"});
    write_grids(dir / "a.vdb", {grid_with("flames"), grid_with("density")});
    EXPECT_EQ(default_of(dir / "a.vdb").names, std::vector<std::string>{"density"});
    EXPECT_TRUE(default_of(dir / "a.vdb").notes.empty());
    EXPECT_EQ(read_volume(dir / "a.vdb", {.refuse_several = true}).name, "density");
}

TEST(vdb_choice, numbered_grids_are_levels_and_files_share_the_choice) {
    const TempDir dir;
    write_grids(dir / "amr.vdb", {grid_with("rho_L1"), grid_with("rho_L0")});
    const std::filesystem::path amr = dir / "amr.vdb";
    std::vector<std::string> notes;
    EXPECT_EQ(read_levels(std::span(&amr, 1), {}, &notes).volumes.size(), 2u);
    EXPECT_EQ(notes,
              std::vector<std::string>{amr.string() + ": reading the grids 'rho_L*' as "
                                                      "levels of one mesh; --grid chooses one"});
    const auto large = grid_with("b");
    openvdb::gridPtrCast<openvdb::FloatGrid>(large)->tree().addTile(1, {8, 0, 0}, 1, true);
    const auto larger = grid_with("a");
    openvdb::gridPtrCast<openvdb::FloatGrid>(larger)->tree().addTile(2, {128, 0, 0}, 1, true);
    write_grids(dir / "1.vdb", {grid_with("a"), large});
    write_grids(dir / "2.vdb", {larger, grid_with("b")});
    write_grids(dir / "3.vdb", {grid_with("c")});
    const std::vector<std::filesystem::path> files{dir / "1.vdb", dir / "2.vdb", dir / "3.vdb"};
    std::vector<std::string> names;
    for (const Volume& volume : read_levels(files).volumes) names.push_back(volume.name);
    EXPECT_EQ(names, (std::vector<std::string>{"b", "b", "c"}));
}

TEST(vdb_choice, without_a_choice_the_names_are_listed) {
    expect_message({grid_with("temperature"), grid_with("flame")},
                   ": no grid named 'density' (it has: temperature, flame)", {.grid = "density"});
    expect_message({grid_with<openvdb::Vec3SGrid>("v")},
                   ": no scalar grid (it has: v); vector grids are read when named");
    expect_message({}, ": no grids");
}

TEST(vdb_choice, grids_of_one_name_are_told_apart_by_number) {
    const TempDir dir;
    const openvdb::GridPtrVec grids{grid_with("density", 1), grid_with("density", 2)};
    write_grids(dir / "a.vdb", grids);
    EXPECT_EQ(first_value(read_vdb(dir / "a.vdb", {.grid = "density[1]"})), 2);
    EXPECT_EQ(read_vdb(dir / "a.vdb", {.grid = "density[0]"}).name, "density");
    expect_message(grids, ": several grids named 'density' (it has: density[0], density[1])",
                   {.grid = "density"});
}

TEST(vdb_choice, grids_that_share_a_tree_keep_their_own_transforms) {
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(grid_with("density", 4));
    const auto other = openvdb::gridPtrCast<openvdb::FloatGrid>(grid->copyGrid());
    other->setName("other");
    other->setTransform(openvdb::math::Transform::createLinearTransform(0.25));
    const TempDir dir;
    write_grids(dir / "a.vdb", {grid, other});
    const Volume volume = read_vdb(dir / "a.vdb", {.grid = "other"});
    EXPECT_EQ(first_value(volume), 4);
    EXPECT_EQ(volume.world_from_index.linear(1, 1), 0.25);
    EXPECT_EQ(read_vdb(dir / "a.vdb").world_from_index.linear(1, 1), 1);
}

TEST(vdb_choice, bool_and_mask_grids_are_0_and_1) {
    const TempDir dir;
    const auto on_off = make_grid<openvdb::BoolGrid>("inside");
    on_off->tree().setValueOn({1, 2, 3}, true);
    on_off->tree().setValueOn({2, 2, 3}, false);
    on_off->tree().addTile(1, {8, 0, 0}, true, true);
    write_grids(dir / "bool.vdb", {on_off});
    const Volume volume = read_vdb(dir / "bool.vdb");
    EXPECT_EQ(volume.name, "inside");
    EXPECT_EQ(active_voxels(volume), 2u + 512u);
    EXPECT_EQ(volume.leaves.at(0).value[static_cast<std::size_t>(leaf_offset(1, 2, 3))], 1);
    EXPECT_EQ(volume.leaves.at(0).value[static_cast<std::size_t>(leaf_offset(2, 2, 3))], 0);
    EXPECT_EQ(volume.tiles.at(0).value, 1);
    write_grids(dir / "mask.vdb",
                {grid_with<openvdb::MaskGrid>("a"), grid_with<openvdb::MaskGrid>("density")});
    EXPECT_EQ(first_value(read_vdb(dir / "mask.vdb")), 1);
    EXPECT_EQ(read_vdb(dir / "mask.vdb").name, "density");
}

TEST(vdb_choice, what_is_no_density_is_refused) {
    expect_message({make_grid("density")}, ": grid 'density': no active voxels");
    const auto inactive = make_grid("density");
    inactive->tree().setValueOff({1, 2, 3}, 4);
    expect_message({inactive}, ": grid 'density': no active voxels");
}

TEST(vdb_choice, any_affine_transform_is_kept) {
    using openvdb::math::Transform;
    const auto read_back = [](const Transform::Ptr& transform) {
        const TempDir dir;
        const auto grid = grid_with("density");
        grid->setTransform(transform);
        write_grids(dir / "a.vdb", {grid});
        return read_vdb(dir / "a.vdb").world_from_index;
    };
    const auto expect_maps_alike = [&](const Transform::Ptr& transform) {
        const Affine map = read_back(transform);
        for (const Vec3d p : {Vec3d{0, 0, 0}, Vec3d{1, 2, 3}, Vec3d{-7, 5, 0.5}}) {
            const openvdb::Vec3d expected = transform->indexToWorld(openvdb::Vec3d(p.x, p.y, p.z));
            // Rounding of products and sums of doubles below 100.
            for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(map(p)[axis], expected[axis], 1e-13);
        }
    };
    expect_maps_alike(Transform::createLinearTransform(0.1));
    auto transform = Transform::createLinearTransform(1.0);
    transform->postTranslate({3, -4, 5});
    expect_maps_alike(transform);  // a translation alone
    transform->preScale(openvdb::Vec3d(0.5, 2, -3));
    expect_maps_alike(transform);  // scales and a mirror
    transform->postRotate(0.7, openvdb::math::Y_AXIS);
    transform->postShear(0.3, openvdb::math::X_AXIS, openvdb::math::Z_AXIS);
    expect_maps_alike(transform);
    transform = Transform::createLinearTransform(1.0);
    transform->postRotate(0.4, openvdb::math::Z_AXIS);
    expect_maps_alike(transform);
}

TEST(vdb_choice, a_frustum_is_refused) {
    const auto grid = grid_with("density");
    grid->setTransform(openvdb::math::Transform::createFrustumTransform(
        openvdb::BBoxd({0, 0, 0}, {10, 10, 10}), 0.5, 10, 1));
    expect_message({grid}, ": grid 'density': transform is a frustum, expected an affine one");
}

TEST(vdb_choice, what_is_no_vdb_file_is_refused) {
    const TempDir dir;
    const auto message = [&](const char* name) {
        return test::error_of([&] { read_vdb(dir / name); });
    };
    EXPECT_EQ(message("absent.vdb"), (dir / "absent.vdb").string() + ": no such file");
    EXPECT_NE(test::error_of([&] { read_vdb(dir / ""); }).find("is a folder"), std::string::npos);
    std::ofstream(dir / "empty.vdb");
    EXPECT_EQ(message("empty.vdb"), (dir / "empty.vdb").string() + ": not a VDB file");
    std::ofstream(dir / "text.vdb") << "x y z\n1 2 3\n";
    EXPECT_EQ(message("text.vdb"), (dir / "text.vdb").string() + ": not a VDB file");
    EXPECT_THROW(inspect_vdb(dir / "text.vdb"), Error);
}

TEST(vdb_choice, a_file_written_as_a_stream_or_too_old_is_refused) {
    const TempDir dir;
    const auto file = dir / "stream.vdb";
    {
        std::ofstream out(file, std::ios::binary);
        openvdb::io::Stream(out).write(openvdb::GridPtrVec{grid_with("density")});
    }
    EXPECT_NE(test::error_of([&] { read_vdb(file); }).find("written as a stream"),
              std::string::npos);
    write_grids(file, {grid_with("density")});
    std::fstream patch(file, std::ios::in | std::ios::out | std::ios::binary);
    patch.seekp(8);  // behind the magic number
    patch.put(static_cast<char>(213));
    patch.close();
    EXPECT_EQ(test::error_of([&] { read_vdb(file); }),
              file.string() + ": VDB file version 213, expected 222 to 225");
}

TEST(vdb_choice, masks_are_values_above_zero_of_any_type) {
    const TempDir dir;
    const auto floats = make_grid<openvdb::FloatGrid>("floats");
    set_voxel(*floats, {1, 2, 3}, 0.25f);
    set_voxel(*floats, {1, 2, 4}, 0.0f);
    set_voxel(*floats, {9, 2, 4}, -1.0f);
    const auto bools = make_grid<openvdb::BoolGrid>("bools");
    set_voxel(*bools, {1, 2, 3}, true);
    set_voxel(*bools, {1, 2, 4}, false);
    const auto masks = make_grid<openvdb::MaskGrid>("masks");
    set_voxel(*masks, {1, 2, 3}, true);
    write_grids(dir / "m.vdb", {floats, bools, masks});
    for (const char* name : {"floats", "bools", "masks"}) {
        SCOPED_TRACE(name);
        ValueNotes notes;
        const Volume mask = read_vdb(dir / "m.vdb", {name, false, true}, &notes);
        EXPECT_EQ(active_voxels(mask), 1u);
        ASSERT_EQ(mask.leaves.size(), 1u);
        EXPECT_EQ(mask.leaves[0].value[leaf_offset(1, 2, 3)], 1);
        EXPECT_EQ(notes.clipped_negative, 0u) << "nothing of density was changed";
    }
    expect_message({grid_with("empty", 0)},
                   ": grid 'empty': no active voxels above 0, expected a mask",
                   {"empty", false, true});
}

}  // namespace
}  // namespace vog
