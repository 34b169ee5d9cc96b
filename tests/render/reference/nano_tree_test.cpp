// nano_tree_test.cpp: NanoVDB grids written from volumes for the reference renderer.
#include "render/reference/nano_tree.h"

#include <gtest/gtest.h>
#include <nanovdb/util/GridValidator.h>

#include "support/random_volume.h"

namespace vog {

using namespace reference;
namespace {

TEST(reference_tree, is_a_valid_nanovdb_grid) {
    for (const auto& [name, map] : test::grid_maps()) {
        Volume volume = test::random_volume(51);
        volume.world_from_index = map;
        const NanoTree tree = nano_tree(volume, false);
        EXPECT_EQ(nanovdb::GridValidator<float>::check(tree.grid(), true), "");
        EXPECT_EQ(tree.grid().activeVoxelCount(), active_voxels(volume));
        EXPECT_STREQ(tree.grid().gridName(), "density");
        for (const Vec3d index : {Vec3d{0, 0, 0}, Vec3d{3, -5, 2000}}) {
            const auto world = tree.grid().indexToWorld(nanovdb::Vec3d(index.x, index.y, index.z));
            EXPECT_LT(length(Vec3d{world[0], world[1], world[2]} - map(index)), 1e-12) << name;
            const auto back = tree.grid().worldToIndex(world);
            EXPECT_LT(length(Vec3d{back[0], back[1], back[2]} - index), 1e-9) << name;
        }
    }
}

TEST(reference_tree, has_every_voxel_and_no_other) {
    Volume volume = test::random_volume(52);
    volume.tiles.pop_back();  // whose border has 786 000 blocks
    for (const bool with_border : {false, true}) {
        const NanoTree tree = nano_tree(volume, with_border);
        const auto accessor = tree.grid().getAccessor();
        for (const Leaf& leaf : volume.leaves)
            for (int n = 0; n < kLeafVoxels; ++n) {
                const nanovdb::Coord at(leaf.origin.x + (n >> 6), leaf.origin.y + (n >> 3 & 7),
                                        leaf.origin.z + (n & 7));
                ASSERT_EQ(accessor.getValue(at), leaf.value[static_cast<std::size_t>(n)]);
                ASSERT_TRUE(accessor.isActive(at) == leaf.active(n) || leaf.active_count() == 0);
            }
        for (const Tile& tile : volume.tiles)
            for (const int inside : {0, tile.edge / 2, tile.edge - 1}) {
                const nanovdb::Coord at(tile.origin.x + inside, tile.origin.y + inside,
                                        tile.origin.z + inside);
                EXPECT_EQ(accessor.getValue(at), tile.value);
                EXPECT_TRUE(tree.root().isActive(at));
            }
        EXPECT_EQ(accessor.getValue({100, 0, 0}), 0);
        EXPECT_FALSE(accessor.isActive({100, 0, 0}));
    }
}

TEST(reference_tree, boxes_of_nodes_hug_their_active_voxels) {
    Volume volume;
    Leaf leaf;
    leaf.origin = {-16, 8, 0};
    leaf.set(leaf_offset(2, 0, 7), 1);
    leaf.set(leaf_offset(4, 6, 7), 1);
    volume.leaves.push_back(leaf);
    const NanoTree tree = nano_tree(volume, false);
    EXPECT_EQ(tree.root().bbox(), nanovdb::CoordBBox({-14, 8, 7}, {-12, 14, 7}));
    EXPECT_EQ(nano_tree({}, false).root().tileCount(), 0u);
}

}  // namespace
}  // namespace vog
