// volume_partition_test.cpp: parts of volumes, in memory and read from files.
#include "vog/distributed.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "data/volume_partition.h"
#include "io/vdb/vdb_reader.h"
#include "support/data.h"
#include "support/vdb_grids.h"
#include "vog/error.h"
#include "vog/sample.h"
#include "vog/volume_io.h"

namespace vog {

using namespace vdb;

namespace {

/// Union of the parts, sorted as readers sort.
Volume joined(const std::vector<Volume>& parts) {
    Volume whole = parts.front();
    for (std::size_t n = 1; n < parts.size(); ++n) {
        whole.leaves.insert(whole.leaves.end(), parts[n].leaves.begin(), parts[n].leaves.end());
        whole.tiles.insert(whole.tiles.end(), parts[n].tiles.begin(), parts[n].tiles.end());
    }
    sort_nodes(whole);
    return whole;
}

std::vector<Volume> parts_of(const Volume& volume, int count, int align = 8) {
    std::vector<Volume> parts;
    for (int n = 0; n < count; ++n) parts.push_back(part_of(volume, {n, count, align}));
    return parts;
}

}  // namespace

TEST(volume_part, parts_are_disjoint_and_together_the_whole) {
    const Volume volume = sample_cloud({.size = 64});
    for (const int count : {1, 2, 3, 7, 500}) {
        const std::vector<Volume> parts = parts_of(volume, count);
        test::expect_same_volume(joined(parts), volume);
        for (const Volume& part : parts) EXPECT_EQ(part.world_from_index, volume.world_from_index);
    }
}

TEST(volume_part, parts_have_about_as_many_voxels) {
    const Volume volume = sample_cloud({.size = 128});
    const auto total = static_cast<double>(active_voxels(volume));
    for (const Volume& part : parts_of(volume, 5)) {
        std::uint64_t voxels = 512 * part.tiles.size();
        for (const Leaf& leaf : part.leaves)
            voxels += static_cast<std::uint64_t>(leaf.active_count());
        EXPECT_NEAR(static_cast<double>(voxels) / total, 0.2, 0.01);
    }
}

TEST(volume_part, runs_begin_where_aligned_cubes_do) {
    const Volume volume = sample_cloud({.size = 128});
    const std::vector<Volume> parts = parts_of(volume, 4, 64);
    const auto cube = [](Vec3i origin) {
        return std::tuple(origin.x >> 6, origin.y >> 6, origin.z >> 6);
    };
    std::map<std::tuple<int, int, int>, std::size_t> owner;
    for (std::size_t n = 0; n < parts.size(); ++n)
        for (const Leaf& leaf : parts[n].leaves) {
            const auto [at, added] = owner.emplace(cube(leaf.origin), n);
            EXPECT_EQ(at->second, n) << "a cube is in two parts";
        }
}

TEST(volume_part, bad_parts_are_refused) {
    const Volume volume = sample_cloud({.size = 64});
    for (const VolumePart part : {VolumePart{0, 0}, VolumePart{-1, 2}, VolumePart{2, 2},
                                  VolumePart{0, 2, 4}, VolumePart{0, 2, 24}})
        EXPECT_THROW(std::ignore = part_of(volume, part), Error);
}

TEST(vdb_reader, parts_of_a_file_are_parts_of_its_volume) {
    const test::TempDir folder;
    const std::filesystem::path file = folder / "cloud.vdb";
    write_vdb(file, sample_cloud({.size = 128}));
    const Volume volume = read_vdb(file);
    VdbReader reader(file);
    EXPECT_EQ(reader.active_voxels(), active_voxels(volume));
    EXPECT_EQ(reader.leaf_count(), volume.leaves.size());
    EXPECT_EQ(reader.world_box(), world_box(volume));
    for (const int count : {1, 3})
        for (int n = 0; n < count; ++n)
            test::expect_same_volume(reader.read({n, count, 16}), part_of(volume, {n, count, 16}));
}

}  // namespace vog
