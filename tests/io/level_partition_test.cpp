// level_partition_test.cpp: depths of the parts of AMR levels add up to the depth of the levels.
#include "vog/distributed.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/reference/reference.h"
#include "support/data.h"
#include "vog/volume_io.h"

namespace vog {
namespace {

/// Volume of dense leaves from `first` on, rotated about z.
/// edge  of a voxel, world units
/// turn  radians
Volume block(Vec3i first, Vec3i leaves, double edge, double turn, const std::string& name) {
    Volume volume;
    volume.name = name;
    const double c = std::cos(turn), s = std::sin(turn);
    volume.world_from_index.linear = {
        {Vec3d{edge * c, -edge * s, 0}, {edge * s, edge * c, 0}, {0, 0, edge}}};
    for (int x = 0; x < leaves.x; ++x)
        for (int y = 0; y < leaves.y; ++y)
            for (int z = 0; z < leaves.z; ++z) {
                Leaf leaf;
                leaf.origin = first + kLeafEdge * Vec3i{x, y, z};
                for (int n = 0; n < kLeafVoxels; ++n)
                    leaf.set(n, 1 + 0.1f * static_cast<float>((n * 7 + x + 3 * y) % 13));
                volume.leaves.push_back(leaf);
            }
    sort_nodes(volume);
    return volume;
}

/// Parameter: rotation of the finer levels, radians.
class level_parts : public testing::TestWithParam<double> {};

TEST_P(level_parts, depths_add_up_to_the_levels) {
    const test::TempDir dir;
    const std::vector<Volume> volumes = {block({-16, -16, -16}, {4, 4, 4}, 1, 0, "coarse"),
                                         block({-8, -16, -8}, {3, 2, 2}, 0.5, GetParam(), "fine"),
                                         block({0, 0, 0}, {1, 1, 1}, 0.25, GetParam(), "finest")};
    write_vdb(dir / "levels.vdb", volumes);
    const Camera camera = paper_view(world_box(volumes[0]));
    constexpr int kSize = 48, kParts = 4;
    const DepthImage whole = render_reference(level_grids({volumes, {}}), camera, kSize, kSize);

    std::vector<double> sum(whole.depth.size());
    std::size_t leaves_held = 0;
    for (int index = 0; index < kParts; ++index) {
        std::vector<VolumeReader> readers;
        for (const Volume& volume : volumes)
            readers.emplace_back(dir / "levels.vdb", VdbOptions{volume.name});
        for (const Levels& levels : read_level_parts(readers, {}, {index, kParts})) {
            for (const Volume& volume : levels.volumes) leaves_held += volume.leaves.size();
            const DepthImage part = render_reference(level_grids(levels), camera, kSize, kSize);
            for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += part.depth[n];
        }
    }
    for (std::size_t n = 0; n < sum.size(); ++n)
        EXPECT_NEAR(sum[n], whole.depth[n], 1e-6 * whole.depth[n]) << n;
    // Each part reads only a share of the finer levels.
    EXPECT_LT(leaves_held, 2 * (64 + 12 + 1));
}

INSTANTIATE_TEST_SUITE_P(, level_parts, testing::Values(0.0, 0.3),
                         [](const auto& turn) { return turn.param == 0 ? "aligned" : "rotated"; });

}  // namespace
}  // namespace vog
