// nvdb_test.cpp: reading of NanoVDB files that NanoVDB wrote, complete, truncated and corrupt.
#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#include <gtest/gtest.h>
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

#include <array>
#include <bit>
#include <limits>

#include "io/scan/scan_files.h"
#include "support/data.h"
#include "support/image_bytes.h"
#include "support/larger_than_memory.h"
#include "support/random_volume.h"
#include "vog/error.h"
#include "vog/openvdb.h"
#include "vog/scan_io.h"
#include "vog/volume_io.h"
#include "vog/voxel_field.h"

namespace vog {
namespace {

using nanovdb::io::Codec;
using test::read_bytes, test::write_bytes;
using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;

/// Grid with a few leaves on both sides of a root border, and a tile of each size.
Volume small_volume() {
    test::Random random(41);
    Volume volume;
    volume.name = "density";
    volume.leaves = {test::random_leaf(random, {-8, 0, 8}, 0.3),
                     test::random_leaf(random, {0, 0, 0}, 1.1)};
    volume.tiles = {{{16, 0, 0}, 8, 0.5f}, {{128, 0, -128}, 128, 0.25f}, {{4096, 0, 0}, 4096, 2}};
    volume.world_from_index = test::grid_maps()[5].second;
    sort_nodes(volume);
    return volume;
}

template <class Grid>
Handle nano(const std::shared_ptr<Grid>& grid,
            nanovdb::ChecksumMode checksum = nanovdb::ChecksumMode::Partial) {
    return nanovdb::openToNanoVDB(*grid, nanovdb::StatsMode::Default, checksum);
}

void write(const std::filesystem::path& file, const Handle& handle, Codec codec = Codec::NONE) {
    nanovdb::io::writeGrid(file.string(), handle, codec);
}

/// Message of read_nvdb about a file that it refuses.
std::string refusal(const std::filesystem::path& file, const VdbOptions& options = {}) {
    try {
        (void)read_nvdb(file, options);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

void expect_says(const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos)
        << "'" << message << "' lacks '" << part << "'";
    EXPECT_EQ(message.find('\n'), std::string::npos);
}

void expect_same(const Volume& a, const Volume& b, float tolerance) {
    ASSERT_EQ(a.leaves.size(), b.leaves.size());
    for (std::size_t i = 0; i < a.leaves.size(); ++i) {
        EXPECT_EQ(a.leaves[i].origin, b.leaves[i].origin);
        EXPECT_EQ(a.leaves[i].mask, b.leaves[i].mask);
        for (std::size_t n = 0; n < kLeafVoxels; ++n)
            ASSERT_NEAR(a.leaves[i].value[n], b.leaves[i].value[n], tolerance);
    }
    ASSERT_EQ(a.tiles.size(), b.tiles.size());
    for (std::size_t i = 0; i < a.tiles.size(); ++i) {
        EXPECT_EQ(a.tiles[i].origin, b.tiles[i].origin);
        EXPECT_EQ(a.tiles[i].edge, b.tiles[i].edge);
        EXPECT_NEAR(a.tiles[i].value, b.tiles[i].value, tolerance);
    }
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_LT(
            length(a.world_from_index.linear.column(axis) - b.world_from_index.linear.column(axis)),
            1e-12);
    EXPECT_LT(length(a.world_from_index.translation - b.world_from_index.translation), 1e-12);
}

TEST(nvdb, every_codec_gives_the_volume_back) {
    const test::TempDir folder;
    const Volume volume = small_volume();
    for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
        const auto file = folder / "small.nvdb";
        write(file, nano(grid_from_volume(volume)), codec);
        ValueNotes notes;
        const Volume read = read_nvdb(file, {}, &notes);
        expect_same(read, volume, 0);
        EXPECT_EQ(read.name, "density");
        EXPECT_EQ(read.source, file.string());
        EXPECT_EQ(notes.clipped_negative, 0u);
    }
}

TEST(nvdb, quantised_grids_come_as_floats) {
    const test::TempDir folder;
    const Volume volume = small_volume();
    const auto grid = grid_from_volume(volume);
    const auto check = [&]<class Build>(Build, double levels) {
        nanovdb::OpenToNanoVDB<float, Build, nanovdb::AbsDiff> converter;
        if constexpr (std::is_same_v<Build, nanovdb::FpN>)
            converter.oracle().setTolerance(static_cast<float>(2 / levels));
        write(folder / "q.nvdb", converter(*grid));
        // Values are below 2 and dithering is off: an error of at most one quantisation level.
        expect_same(read_nvdb(folder / "q.nvdb"), volume, static_cast<float>(2 / levels));
    };
    check(nanovdb::Fp4{}, 15);
    check(nanovdb::Fp8{}, 255);
    check(nanovdb::Fp16{}, 65535);
    check(nanovdb::FpN{}, 100);
}

TEST(nvdb, other_numbers_and_vectors_are_read) {
    const test::TempDir folder;
    const auto check = [&]<class Value>(Value value, double expected) {
        nanovdb::GridBuilder<Value> builder(Value(0));
        builder.getAccessor().setValue({1, 2, 3}, value);
        write(folder / "a.nvdb", builder.getHandle(1.0, nanovdb::Vec3d(0), "a"));
        VdbOptions options;
        options.grid = "a";
        options.values.clip_negative = true;
        const Volume volume = read_nvdb(folder / "a.nvdb", options);
        ASSERT_EQ(volume.leaves.size(), 1u);
        EXPECT_EQ(volume.leaves[0].active_count(), 1);
        EXPECT_FLOAT_EQ(volume.leaves[0].value[leaf_offset(1, 2, 3)], static_cast<float>(expected));
    };
    check(2.5, 2.5);
    check(std::int16_t{-5}, 0);
    check(std::int32_t{7}, 7);
    check(std::uint32_t{4'000'000'000}, 4e9);
    check(std::int64_t{1} << 40, 0x1p40);
    check(nanovdb::Vec3d(2, 3, 6), 7);
    check(nanovdb::Vec3f(2, 3, 6), 7);
    expect_says(refusal(folder / "a.nvdb"), "no scalar grid (it has: a)");

    const auto mask = openvdb::MaskGrid::create();
    mask->tree().setValueOn({0, 0, 0});
    mask->setName("m");
    write(folder / "mask.nvdb", nano(mask));
    EXPECT_EQ(read_nvdb(folder / "mask.nvdb").leaves.at(0).value[0], 1);
    const auto on_off = openvdb::BoolGrid::create();
    on_off->tree().setValueOn({0, 0, 0}, true);
    on_off->tree().setValueOn({0, 0, 1}, false);
    write(folder / "bool.nvdb", nano(on_off));
    const Volume switches = read_nvdb(folder / "bool.nvdb");
    EXPECT_EQ(active_voxels(switches), 2u);
    EXPECT_EQ(switches.leaves.at(0).value[0], 1);
    EXPECT_EQ(switches.leaves.at(0).value[1], 0);
}

TEST(nvdb, grids_are_chosen_by_name) {
    const test::TempDir folder;
    Volume volume = small_volume();
    std::vector<Handle> handles;
    handles.push_back(nano(grid_from_volume(volume)));
    volume.tiles.pop_back();
    volume.name = "heat";
    handles.push_back(nano(grid_from_volume(volume)));
    const auto file = folder / "two.nvdb";
    nanovdb::io::writeGrids(file.string(), handles, Codec::ZIP);
    EXPECT_EQ(read_nvdb(file).name, "density");
    VdbOptions options;
    options.grid = "heat";
    expect_same(read_nvdb(file, options), volume, 0);
    options.grid = "smoke";
    expect_says(refusal(file, options), "no grid named 'smoke' (it has: density, heat)");

    // Two segments in one file.
    const auto once = read_bytes(file);
    write_bytes(file, once + once);
    options.grid = "heat";
    expect_says(refusal(file, options),
                "several grids named 'heat' (it has: density[0], heat[0], density[1], heat[1])");
    options.grid = "heat[1]";
    expect_same(read_nvdb(file, options), volume, 0);
    write_bytes(folder / "two.nvdb.gz", test::gzipped(once + once));
    expect_same(read_volume(folder / "two.nvdb.gz", options), volume, 0);
    const std::vector<VolumeInfo> infos = inspect_volume(folder / "two.nvdb.gz");
    ASSERT_EQ(infos.size(), 4u);
    EXPECT_EQ(infos[3].grid.name, "heat[1]");
    EXPECT_EQ(infos[3].grid.active_voxels, active_voxels(volume));
    write_bytes(file, once + "tail");
    EXPECT_NE(refusal(file), "");
}

TEST(nvdb, invalid_values_are_refused_or_accepted_by_the_rules) {
    const test::TempDir folder;
    const auto grid = openvdb::FloatGrid::create();
    grid->setName("density");
    for (int i = 0; i < 3; ++i) grid->tree().setValue({i, 0, 0}, float(i - 2));
    grid->tree().setValueOff({5, 5, 5}, 9);
    write(folder / "a.nvdb", nano(grid));
    ValueNotes notes;
    expect_says(refusal(folder / "a.nvdb"),
                "2 active values are negative, the first at index [0, 0, 0]");
    VdbOptions accept;
    accept.values = {true, true};
    const Volume volume = read_nvdb(folder / "a.nvdb", accept, &notes);
    EXPECT_EQ(notes.clipped_negative, 2u);
    EXPECT_EQ(mass(volume), 0) << "inactive values do not count";
    EXPECT_EQ(active_voxels(volume), 3u);

    grid->tree().setValue({9, 0, 0}, std::numeric_limits<float>::quiet_NaN());
    write(folder / "a.nvdb", nano(grid));
    expect_says(refusal(folder / "a.nvdb"), "1 active values are not finite");
    EXPECT_EQ(active_voxels(read_nvdb(folder / "a.nvdb", accept, &notes)), 3u);
    EXPECT_EQ(notes.skipped_nonfinite, 1u);
    write(folder / "empty.nvdb", nano(openvdb::FloatGrid::create()));
    expect_says(refusal(folder / "empty.nvdb"), "no active voxels");
}

TEST(nvdb, level_set_is_refused_unless_fog_is_asked_for) {
    const test::TempDir folder;
    const auto grid = openvdb::FloatGrid::create(3);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    for (int x = -3; x <= 3; ++x) grid->tree().setValue({x, 0, 0}, float(x));
    write(folder / "set.nvdb", nano(grid));
    expect_says(refusal(folder / "set.nvdb"), "a level set");
    VdbOptions options;
    options.level_set_to_fog = true;
    EXPECT_GT(mass(read_nvdb(folder / "set.nvdb", options)), 1);
}

TEST(nvdb, fields_have_any_sign_and_ones_count_their_voxels) {
    const test::TempDir folder;
    const auto grid = openvdb::FloatGrid::create(-7);
    grid->setName("hu");
    for (int x = 0; x < 8; ++x) grid->tree().setValue({x, 1, 2}, float(x) - 4);
    grid->tree().addTile(1, {8, 0, 0}, -2, true);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    write(folder / "a.nvdb", nano(grid), Codec::ZIP);
    Volume volume = read_volume(folder / "a.nvdb", {.ones = true});
    EXPECT_EQ(mass(volume), (8 + 512) / 8.0);
    std::vector<std::string> notes;
    const VoxelField field = read_field({.file = folder / "a.nvdb"}, volume, {}, &notes);
    EXPECT_EQ(field.name, "hu");
    EXPECT_EQ(field.lower, -4);
    EXPECT_EQ(field.upper, 3);
    EXPECT_EQ(field.component[0].tile, std::vector<float>{-2});
    for (int x = 0; x < 8; ++x)
        EXPECT_EQ(field.component[0].leaf[0][std::size_t(leaf_offset(x, 1, 2))], float(x) - 4);
    EXPECT_TRUE(notes.empty());

    // Staggered vectors at a measure of 4 voxels; the last has no upper face.
    nanovdb::GridBuilder<nanovdb::Vec3f> builder(nanovdb::Vec3f(0), nanovdb::GridClass::Staggered);
    for (int x = 0; x < 4; ++x)
        builder.getAccessor().setValue({x, 0, 0}, nanovdb::Vec3f(float(x), -1, 2));
    write(folder / "v.nvdb", builder.getHandle(1.0, nanovdb::Vec3d(0), "v"));
    Volume line;
    line.leaves.resize(1);
    for (int x = 0; x < 4; ++x) line.leaves[0].set(leaf_offset(x, 0, 0), 1);
    const VoxelField v = read_field({.file = folder / "v.nvdb", .grid = "v"}, line);
    ASSERT_TRUE(v.is_vector());
    for (int x = 0; x < 4; ++x) {
        const auto at = std::size_t(leaf_offset(x, 0, 0));
        EXPECT_EQ(v.component[0].leaf[0][at], x == 3 ? 3 : float(x) + 0.5f);
        EXPECT_EQ(v.component[1].leaf[0][at], -1);
        EXPECT_EQ(v.component[2].leaf[0][at], 2);
    }
}

TEST(nvdb, foreign_and_other_versions_are_named) {
    const test::TempDir folder;
    const auto file = folder / "a.nvdb";
    EXPECT_NE(refusal(folder / "none.nvdb").find("no such file"), std::string::npos);
    write_bytes(file, "");
    expect_says(refusal(file), "not a NanoVDB file");
    write_bytes(file, "VDB is another format, and this is none of it");
    expect_says(refusal(file), "not a NanoVDB file");

    write(file, nano(grid_from_volume(small_volume())), Codec::ZIP);
    const std::string whole = read_bytes(file);
    const auto with_version = [&](std::uint32_t version) {
        std::string bytes = whole;
        bytes.replace(8, 4, {reinterpret_cast<const char*>(&version), 4});
        write_bytes(file, bytes);
        return refusal(file);
    };
    expect_says(with_version(31u << 21 | 3u << 10 | 1), "version 31.3.1, expected 32.x");
    expect_says(with_version(28), "version 28, expected 32.x");
    expect_says(with_version(33u << 21), "version 33.0.0, expected 32.x");
    EXPECT_EQ(with_version(32u << 21 | 9u << 10), "");
    std::string newer = whole;
    newer[7] = '2';  // files since 32.6 start so
    write_bytes(file, newer);
    EXPECT_EQ(refusal(file), "");
    newer[7] = '1';
    write_bytes(file, newer);
    expect_says(refusal(file), "without a file header");
    std::string codec = whole;
    codec[14] = 7;
    write_bytes(file, codec);
    expect_says(refusal(file), "codec 7");
}

TEST(nvdb, truncated_file_throws_at_every_length) {
    const test::TempDir folder;
    const auto file = folder / "a.nvdb";
    for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
        write(file, nano(grid_from_volume(small_volume())), codec);
        // Uncompressed files are mostly empty tables: lengths between are one read and are skipped.
        const bool bare = codec == Codec::NONE;
        for (std::size_t size = std::filesystem::file_size(file); size-- > 0;) {
            if (bare && size > 2000 && size % 499 != 0) continue;
            std::filesystem::resize_file(file, size);
            ASSERT_NE(refusal(file), "") << size;
        }
    }
}

TEST(nvdb, checksums_find_changed_bytes) {
    const test::TempDir folder;
    const auto file = folder / "a.nvdb";
    const auto grid = grid_from_volume(small_volume());
    const auto with_flipped = [&](nanovdb::ChecksumMode mode, std::size_t from_end) {
        write(file, nano(grid, mode));
        std::string bytes = read_bytes(file);
        bytes[bytes.size() - from_end] ^= 1;
        write_bytes(file, bytes);
        return refusal(file);
    };
    constexpr std::size_t kLastValue = 4;  // the lowest byte of the last leaf's last value
    expect_says(with_flipped(nanovdb::ChecksumMode::Full, kLastValue), "node checksum");
    EXPECT_EQ(with_flipped(nanovdb::ChecksumMode::Partial, kLastValue), "");
    write(file, nano(grid, nanovdb::ChecksumMode::Full));
    EXPECT_EQ(refusal(file), "");
    const std::size_t grid_bytes = nano(grid).size();
    const std::size_t transform = offsetof(nanovdb::GridData, mMap) + offsetof(nanovdb::Map, mMatD);
    expect_says(with_flipped(nanovdb::ChecksumMode::Partial, grid_bytes - transform),
                "header checksum");
}

TEST(nvdb, random_damage_never_does_more_than_throw) {
    const test::TempDir folder;
    const auto file = folder / "a.nvdb";
    test::Random random(42);
    for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
        // Without a checksum, so that changed bytes reach the check of the tree.
        write(file, nano(grid_from_volume(small_volume()), nanovdb::ChecksumMode::Disable), codec);
        const std::string whole = read_bytes(file);
        int refused = 0;
        for (int trial = 0; trial < 80; ++trial) {
            std::string bytes = whole;
            for (int flip = 0; flip < 8; ++flip) {
                // Half of the changes are in the headers of file, grid, tree and root.
                const double span = random() < 0.5 ? 1400 : double(bytes.size());
                bytes[std::size_t(random() * span) % bytes.size()] = char(random() * 256);
            }
            write_bytes(file, bytes);
            refused += !refusal(file).empty();
        }
        EXPECT_GT(refused, 15);
    }
}

TEST(nvdb, shared_children_do_not_multiply) {
    // All 32768 cells of the upper node point to its one lower node.
    const test::TempDir folder;
    Volume volume = small_volume();
    volume.leaves.erase(volume.leaves.begin());
    volume.tiles.clear();
    Handle handle = nano(grid_from_volume(volume), nanovdb::ChecksumMode::Disable);
    auto& root = handle.grid<float>()->tree().root();
    auto& upper = *root.data()->getChild(root.data()->tile(0));
    auto& lower = *upper.data()->getChild(0);
    upper.data()->mChildMask.setOn();
    for (std::uint32_t n = 0; n < 32768; ++n) upper.data()->setChild(n, &lower);
    write(folder / "a.nvdb", handle);
    expect_says(refusal(folder / "a.nvdb"), "overlapping nodes");
}

class nvdb_larger_than_memory : public test::LargerThanMemory {};

// 33,000 leaves: 70 MB each in the file, decompressed, and as a volume.
TEST_F(nvdb_larger_than_memory, a_grid_makes_the_same_model) {
    write_cube("cube.vdb", 32);
    vog::write(dir_ / "cube.nvdb", nano(grid_from_volume(read_vdb(dir_ / "cube.vdb"))));
    expect_same("convert cube.nvdb --block 8 --set soft-steps=0 -o", ".ply", 144);
}

}  // namespace
}  // namespace vog
