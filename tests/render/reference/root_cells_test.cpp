// root_cells_test.cpp: volumes of thousands of nodes under the root.
#include "render/reference/root_cells.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "render/reference/reference.h"
#include "support/ray_voxels.h"
#include "support/scenes.h"

namespace vog {
namespace {

/// Tiles of 4096 voxels and leaves at random places, each under a root cell of its own.
Volume scattered(int tiles, int leaves) {
    test::Random random(7);
    std::set<std::tuple<int, int, int>> taken;
    const auto place = [&] {
        while (true) {
            const auto at = [&] { return 4096 * static_cast<int>(random(-12, 12)); };
            const Vec3i origin{at(), at(), at()};
            if (taken.insert({origin.x, origin.y, origin.z}).second) return origin;
        }
    };
    Volume volume;
    for (int n = 0; n < tiles; ++n)
        volume.tiles.push_back({place(), 4096, static_cast<float>(random(0.1, 1))});
    for (int n = 0; n < leaves; ++n) {
        Leaf& leaf = volume.leaves.emplace_back();
        leaf.origin = place() + Vec3i{8 * (n % 500), 0, 8};
        for (int voxel = 0; voxel < kLeafVoxels; ++voxel)
            leaf.set(voxel, static_cast<float>(random(0.1, 100)));
    }
    sort_nodes(volume);
    return volume;
}

TEST(root_cells, a_ray_meets_every_cell_on_it) {
    const Volume volume = scattered(3000, 20);
    const VoxelGrid grid = voxel_grid(volume);
    test::Random random(8);
    int hits = 0;
    for (int ray = 0; ray < 300; ++ray) {
        // Every tenth along an axis, within a face between cells.
        const bool axis = ray % 10 == 0;
        const Vec3d from =
            axis ? Vec3d{-200000, 4096.0 * (ray % 20) - 0.5, 2048} : random.in_cube(40000);
        const Vec3d direction = axis ? Vec3d{1, 0, 0} : random.in_cube(1);
        double expected = 0;
        const test::IndexRay index_ray(volume, from, direction);
        const auto add = [&](Vec3i origin, int edge, double value) {
            const Vec3d lower = vec_cast<double>(origin) - Vec3d{0.5, 0.5, 0.5};
            const double size = edge;
            const auto [first, last] = index_ray.cut(lower, lower + Vec3d{size, size, size});
            if (last > first) expected += value * (last - first) * length(direction), ++hits;
        };
        for (const Tile& tile : volume.tiles) add(tile.origin, tile.edge, double{tile.value});
        for (const Leaf& leaf : volume.leaves)
            for (int n = 0; n < kLeafVoxels; ++n)
                add(leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7}, 1,
                    double{leaf.value[static_cast<std::size_t>(n)]});
        EXPECT_NEAR(optical_depth(grid, from, direction), expected, 1e-9 * (1 + expected)) << ray;
    }
    EXPECT_GT(hits, 1000);
}

TEST(root_cells, every_cell_is_in_one_leaf_of_the_hierarchy) {
    const reference::NanoTree tree = reference::nano_tree(scattered(1001, 10), false);
    const reference::RootCells cells(tree.root(), {});
    std::set<std::tuple<double, double, double>> origins;
    std::size_t count = 0;
    for (std::size_t n = 0; n < cells.nodes().size(); ++n) {
        const auto& node = cells.nodes()[n];
        EXPECT_GT(node.skip, n);
        EXPECT_LE(node.count, 4u);  // so that a ray tests few cells
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i, ++count)
            origins.insert({cells[i].origin.x, cells[i].origin.y, cells[i].origin.z});
    }
    EXPECT_EQ(count, 1011u);
    EXPECT_EQ(origins.size(), 1011u);
}

}  // namespace
}  // namespace vog
