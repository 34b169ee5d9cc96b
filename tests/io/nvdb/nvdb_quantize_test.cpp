// nvdb_quantize_test.cpp: quantised .nvdb files: errors, sizes, refusals.
#include "io/nvdb/nvdb_quantize.h"

#include <gtest/gtest.h>

#include "support/data.h"
#include "support/random_volume.h"
#include "support/vdb_grids.h"
#include "vog/error.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

using nvdb::NanoCodes;

Volume leaves_and_tiles() {
    Volume volume = random_volume(7);
    std::erase_if(volume.leaves, [](const Leaf& leaf) { return leaf.active_count() == 0; });
    return volume;
}

/// Largest error of a value, in units of the range of its leaf, 0 included where voxels are inactive.
double largest_error(const Volume& truth, const Volume& read, bool relative) {
    EXPECT_EQ(truth.leaves.size(), read.leaves.size());
    double largest = 0;
    for (std::size_t n = 0; n < truth.leaves.size(); ++n) {
        const Leaf &a = truth.leaves[n], &b = read.leaves[n];
        EXPECT_EQ(a.origin, b.origin);
        EXPECT_EQ(a.mask, b.mask);
        const auto [low, high] = std::ranges::minmax(a.value);
        for (std::size_t v = 0; v < a.value.size(); ++v)
            largest = std::max(largest, std::abs(double{a.value[v]} - b.value[v]) /
                                            (relative ? double{high} - low : 1.0));
    }
    return largest;
}

}  // namespace

TEST(nvdb_quantize, values_are_within_half_a_step_and_files_grow_with_bits) {
    const TempDir dir;
    const Volume volume = leaves_and_tiles();
    std::uintmax_t before = 0;
    for (const auto& [codes, bits] : {std::pair{NanoCodes::fp4, 4},
                                      {NanoCodes::fp8, 8},
                                      {NanoCodes::fp16, 16},
                                      {NanoCodes::f32, 0}}) {
        SCOPED_TRACE(bits);
        write_nvdb(dir / "v.nvdb", volume, codes, 0, true);
        const Volume read = read_nvdb(dir / "v.nvdb");
        if (bits == 0)
            expect_same_volume(read, volume);
        else  // rounding of the decoder's floats beside the step
            EXPECT_LE(largest_error(volume, read, true), 0.5 / ((1 << bits) - 1) + 1e-6);
        EXPECT_EQ(read.tiles.size(), volume.tiles.size());
        EXPECT_NEAR(mass(read), mass(volume), 0.01 * mass(volume));
        EXPECT_GT(std::filesystem::file_size(dir / "v.nvdb"), before);
        before = std::filesystem::file_size(dir / "v.nvdb");
    }
}

TEST(nvdb_quantize, fpn_meets_its_tolerance_with_fewer_bytes_for_a_wider_one) {
    const TempDir dir;
    const Volume volume = leaves_and_tiles();
    std::uintmax_t before = 0;
    for (const float tolerance : {0.3f, 0.02f, 0.001f}) {
        write_nvdb(dir / "v.nvdb", volume, NanoCodes::fpn, tolerance, true);
        EXPECT_LE(largest_error(volume, read_nvdb(dir / "v.nvdb"), false), tolerance);
        EXPECT_GT(std::filesystem::file_size(dir / "v.nvdb"), before);
        before = std::filesystem::file_size(dir / "v.nvdb");
    }
}

TEST(nvdb_quantize, empty_volumes_tolerances_and_folders_are_refused) {
    const TempDir dir;
    const Volume volume = leaves_and_tiles();
    EXPECT_THROW(write_nvdb(dir / "v.nvdb", Volume{}, NanoCodes::fp8, 0, true), Error);
    EXPECT_THROW(write_nvdb(dir / "v.nvdb", volume, NanoCodes::fpn, 0, true), Error);
    EXPECT_THROW(write_nvdb(dir / "none/v.nvdb", volume, NanoCodes::fp8, 0, true), Error);
    EXPECT_FALSE(std::filesystem::exists(dir / "v.nvdb"));
}

}  // namespace vog::test
