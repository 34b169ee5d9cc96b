// leaf_file_test.cpp: files of leaves: masks without loss, values within the tolerance, damaged files.
#include "evaluate/rate/leaf_file.h"

#include <gtest/gtest.h>

#include <cstring>

#include "support/command.h"
#include "support/random_volume.h"
#include "vog/error.h"

namespace vog::test {

namespace {

using namespace evaluation;

/// Floats as they are: the file without the loss of a library.
std::string raw_encoded(std::span<const float> value, double) {
    return {reinterpret_cast<const char*>(value.data()), value.size_bytes()};
}
void raw_decoded(const std::string& bytes, std::span<float> value) {
    if (bytes.size() != value.size_bytes()) throw Error("raw: corrupt values");
    std::memcpy(value.data(), bytes.data(), bytes.size());
}
const FloatCodec kRaw{"raw", raw_encoded, raw_decoded};

/// Largest error over all voxels of leaves, also of inactive ones.
double largest_error(const Volume& a, const Volume& b) {
    EXPECT_EQ(a.leaves.size(), b.leaves.size());
    double largest = 0;
    for (std::size_t n = 0; n < a.leaves.size(); ++n)
        for (std::size_t v = 0; v < kLeafVoxels; ++v)
            largest =
                std::max(largest, std::abs(double{a.leaves[n].value[v]} - b.leaves[n].value[v]));
    return largest;
}

}  // namespace

TEST(leaf_file, voxels_tiles_and_transform_come_back_exactly_from_exact_values) {
    const TempDir dir;
    for (const auto& [name, map] : grid_maps()) {
        SCOPED_TRACE(name);
        Volume volume = random_volume(4);
        volume.world_from_index = map;
        for (const LeafMask mask : {LeafMask::stored, LeafMask::none}) {
            const std::uint64_t side = write_leaf_file(dir / "v", volume, kRaw, 1, mask);
            EXPECT_LT(side, std::filesystem::file_size(dir / "v"));
            const Volume read = read_leaf_file(dir / "v", kRaw);
            EXPECT_TRUE(read.world_from_index == map);
            EXPECT_EQ(largest_error(volume, read), 0);
            ASSERT_EQ(read.tiles.size(), 3u);
            for (std::size_t n = 0; n < 3; ++n) {
                EXPECT_EQ(read.tiles[n].origin, volume.tiles[n].origin);
                EXPECT_EQ(read.tiles[n].edge, volume.tiles[n].edge);
                EXPECT_EQ(read.tiles[n].value, volume.tiles[n].value);
            }
            for (std::size_t n = 0; n < read.leaves.size(); ++n) {
                EXPECT_EQ(read.leaves[n].origin, volume.leaves[n].origin);
                EXPECT_EQ(read.leaves[n].mask, volume.leaves[n].mask);
            }
        }
    }
}

TEST(leaf_file, every_codec_of_this_build_keeps_its_tolerance) {
    const TempDir dir;
    const Volume volume = random_volume(5);
    int codecs = 0;
    for (const FloatCodec* codec : {zfp_codec(), sz3_codec()}) {
        if (!codec) continue;
        ++codecs;
        for (const LeafMask mask : {LeafMask::stored, LeafMask::none}) {
            std::uintmax_t before = 0;
            for (const double tolerance : {0.5, 0.03, 0.001}) {
                SCOPED_TRACE(codec->name + " " + std::to_string(tolerance));
                write_leaf_file(dir / "v", volume, *codec, tolerance, mask);
                const Volume read = read_leaf_file(dir / "v", *codec);
                EXPECT_LE(largest_error(volume, read), tolerance);
                EXPECT_GT(largest_error(volume, read), 0);
                EXPECT_NO_THROW(validate(read));
                EXPECT_GT(std::filesystem::file_size(dir / "v"), before);
                before = std::filesystem::file_size(dir / "v");
            }
        }
    }
    if (codecs == 0) GTEST_SKIP() << "neither ZFP nor SZ3 in this build";
}

TEST(leaf_file, inactive_voxels_continue_active_ones_and_cost_little) {
    const FloatCodec* zfp = zfp_codec();
    if (!zfp) GTEST_SKIP() << "no ZFP in this build";
    const TempDir dir;
    Volume volume;  // constant where active: with masks nothing but constants is coded
    for (int n = 0; n < 8; ++n) {
        Leaf& leaf = volume.leaves.emplace_back();
        leaf.origin = {0, 0, 8 * n};
        for (int v = 0; v < kLeafVoxels; ++v)
            if ((v * 7 + n) % 5 < 2) leaf.set(v, 0.75f);
    }
    const auto value_bytes = [&](LeafMask mask) {
        const std::uint64_t side = write_leaf_file(dir / "v", volume, *zfp, 0.01, mask);
        return std::filesystem::file_size(dir / "v") - side;
    };
    EXPECT_LT(5 * value_bytes(LeafMask::stored), value_bytes(LeafMask::none));
}

TEST(leaf_file, a_volume_of_tiles_alone_has_no_values) {
    const TempDir dir;
    Volume volume = random_volume(4);
    volume.leaves.clear();
    write_leaf_file(dir / "v", volume, kRaw, 1, LeafMask::stored);
    const Volume read = read_leaf_file(dir / "v", kRaw);
    EXPECT_TRUE(read.leaves.empty());
    EXPECT_EQ(read.tiles.size(), 3u);
}

TEST(leaf_file, truncated_and_damaged_files_are_refused) {
    const TempDir dir;
    Volume volume = random_volume(4);
    volume.leaves.resize(2);
    write_leaf_file(dir / "v", volume, kRaw, 1, LeafMask::stored);
    const std::string bytes = read_text(dir / "v");
    const auto refused = [&](const std::string& text) {
        std::ofstream(dir / "w", std::ios::binary) << text;
        EXPECT_THROW((void)read_leaf_file(dir / "w", kRaw), Error) << text.size();
    };
    for (std::size_t length = 0; length < bytes.size(); length += length < 200 ? 1 : 97)
        refused(bytes.substr(0, length));
    // Checksums of zstd cover what lies behind the header's 48 bytes.
    for (std::size_t at : {std::size_t{0}, std::size_t{16}, std::size_t{25}, std::size_t{34},
                           std::size_t{41}, std::size_t{70}, bytes.size() / 2, bytes.size() - 6}) {
        std::string damaged = bytes;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x15);
        refused(damaged);
    }
    EXPECT_THROW((void)read_leaf_file(dir / "none", kRaw), Error);
}

}  // namespace vog::test
