// vdb_corrupt_test.cpp: truncated and changed files are refused with one line, or read safely.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "support/data.h"
#include "support/refused_files.h"
#include "support/vdb_grids.h"
#include "vog/volume_io.h"

namespace vog {
namespace {

using openvdb::FloatGrid;
using test::make_grid;
using test::TempDir;

/// Bytes of a file with these grids.
std::string file_bytes(const openvdb::GridPtrVec& grids,
                       std::uint32_t compression = test::kDefaultCompression) {
    const TempDir dir;
    test::write_grids(dir / "whole.vdb", grids, compression);
    return test::read_bytes(dir / "whole.vdb");
}

openvdb::GridBase::Ptr small_grid(const std::string& name) {
    const auto grid = make_grid(name);
    for (int i = 0; i < 10; ++i) test::set_voxel(*grid, {i, 0, 0}, 0.5f);
    grid->tree().addTile(1, openvdb::Coord(64, 64, 64), 3, true);
    return grid;
}

/// Offset of the end position of a file's only grid, the last of three positions before the grid.
std::size_t end_offset(const std::string& bytes, const std::string& tree_type) {
    return bytes.find(tree_type) + tree_type.size() + 4 + 2 * 8;
}

void read_everything(const std::filesystem::path& file, const std::string& grid) {
    const auto try_to = [](auto call) {
        try {
            call();
        } catch (const Error& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        }
    };
    try_to([&] { validate(read_vdb(file, {.grid = grid})); });
    try_to([&] { validate(read_vdb(file, {.grid = grid, .level_set_to_fog = true})); });
    try_to([&] { inspect_vdb(file); });
}

/// Reads files with bytes changed at fixed pseudo-random offsets, half of them nonzero bytes: most
/// of a small file is empty masks.
void expect_survives_flips(const std::string& bytes, const std::string& grid, int flips,
                           unsigned seed) {
    std::vector<std::size_t> not_zero;
    for (std::size_t i = 0; i < bytes.size(); ++i)
        if (bytes[i] != 0) not_zero.push_back(i);
    std::mt19937 random(seed);
    const TempDir dir;
    for (int i = 0; i < flips; ++i) {
        std::string changed = bytes;
        const std::size_t place =
            i % 2 ? not_zero[random() % not_zero.size()] : random() % bytes.size();
        // One bit, or a whole byte: small and large errors of sizes.
        const auto change = i % 4 < 2 ? 1u << (random() % 8) : 1 + random() % 255;
        changed[place] = static_cast<char>(changed[place] ^ static_cast<char>(change));
        SCOPED_TRACE(testing::Message() << "byte " << place << " changed by " << change);
        test::write_bytes(dir / "changed.vdb", changed);
        read_everything(dir / "changed.vdb", grid);
    }
}

TEST(vdb_corrupt, every_truncation_throws) {
    test::expect_all_truncations_refused(file_bytes({small_grid("a"), small_grid("density")}),
                                         [](const auto& file) { read_vdb(file); });
}

TEST(vdb_corrupt, a_truncated_file_says_so) {
    const std::string bytes = file_bytes({small_grid("density")});
    test::expect_refused(
        bytes.substr(0, bytes.size() - 1), [](const auto& file) { read_vdb(file); },
        ": truncated: grid 'density' ends at byte");
    test::expect_refused(
        bytes.substr(0, 30), [](const auto& file) { inspect_vdb(file); }, ": truncated");
}

TEST(vdb_corrupt, every_truncation_throws_though_the_header_hides_it) {
    // The end position of the grid is set to the end of the truncated file, so that only the check
    // of the tree can detect the truncation.
    const std::string whole = file_bytes({test::varied_grid("density")});
    const std::string tree_type = FloatGrid::gridType();
    const std::size_t end = end_offset(whole, tree_type);
    ASSERT_EQ(whole.substr(end, 8),
              test::little_endian<std::int64_t>(static_cast<std::int64_t>(whole.size())));
    const TempDir dir;
    std::size_t step = 1;
    for (std::size_t size = whole.size() - 1; size > end + 8; size -= std::min(size, step)) {
        if (whole.size() - size > 600) step = 97;  // every length near the end, where leaves are
        std::string cut = whole.substr(0, size);
        cut.replace(end, 8, test::little_endian<std::int64_t>(static_cast<std::int64_t>(size)));
        test::write_bytes(dir / "cut.vdb", cut);
        EXPECT_THROW(read_vdb(dir / "cut.vdb"), Error) << size << " of " << whole.size();
        EXPECT_THROW(inspect_vdb(dir / "cut.vdb"), Error) << size << " of " << whole.size();
    }
}

TEST(vdb_corrupt, an_end_left_at_zero_means_the_end_of_the_file) {
    std::string bytes = file_bytes({small_grid("density")});
    bytes.replace(end_offset(bytes, FloatGrid::gridType()), 8, std::string(8, '\0'));
    const TempDir dir;
    test::write_bytes(dir / "open.vdb", bytes);
    EXPECT_EQ(active_voxels(read_vdb(dir / "open.vdb")), 10u + 512u);
}

TEST(vdb_corrupt, a_wrong_size_of_a_block_is_refused) {
    // OpenVDB 10.0.1 reads as many bytes as a negative size declares into a buffer of fixed size.
    const std::string bytes = file_bytes({small_grid("density")});
    const TempDir dir;
    int refused = 0;
    for (std::size_t i = bytes.size() - 60; i < bytes.size() - 8; ++i) {
        std::string changed = bytes;
        changed.replace(i, 8, test::little_endian<std::int64_t>(-1'000'000));
        test::write_bytes(dir / "changed.vdb", changed);
        try {
            read_vdb(dir / "changed.vdb");
        } catch (const Error&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 10);
}

TEST(vdb_corrupt, lengths_that_cannot_be_allocate_nothing) {
    const std::string bytes = file_bytes({small_grid("density")});
    const auto refused = [&](std::size_t place) {
        std::string changed = bytes;
        changed.replace(place, 4, "\xf0\xff\xff\x7f");  // two thousand million
        test::expect_refused(
            changed, [](const auto& file) { read_vdb(file); }, "truncated or corrupt");
    };
    refused(bytes.find("density") - 4);
    refused(bytes.find("Tree_float") - 4);
    refused(bytes.find("class") - 4);
    refused(bytes.find("fog volume") - 4);
    refused(bytes.find("class") - 8);  // number of metadata
}

struct Kind {
    const char* name;
    openvdb::GridBase::Ptr (*make)();
    std::uint32_t compression;
};
/// The name stands for the kind in test listings.
void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

class vdb_flips : public testing::TestWithParam<Kind> {};

TEST_P(vdb_flips, no_changed_byte_crashes) {
    const openvdb::GridBase::Ptr grid = GetParam().make();
    expect_survives_flips(file_bytes({grid}, GetParam().compression), grid->getName(), 300, 1);
}

template <class GridT, bool half = false>
openvdb::GridBase::Ptr unknown_class() {
    const auto grid = test::varied_grid<GridT>("density", openvdb::GRID_UNKNOWN);
    grid->setSaveFloatAsHalf(half);
    return grid;
}

constexpr std::uint32_t kZip = openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK;
INSTANTIATE_TEST_SUITE_P(
    kinds, vdb_flips,
    testing::Values(Kind{"float_blosc", unknown_class<FloatGrid>, test::kDefaultCompression},
                    Kind{"half_zip", unknown_class<FloatGrid, true>, kZip},
                    Kind{"double_plain", unknown_class<openvdb::DoubleGrid>, 0},
                    Kind{"vector_blosc", unknown_class<openvdb::Vec3SGrid>,
                         test::kDefaultCompression}),
    [](const auto& kind) { return std::string(kind.param.name); });

}  // namespace
}  // namespace vog
