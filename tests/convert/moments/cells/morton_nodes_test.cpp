// morton_nodes_test.cpp: neighbours of leaves against a search among all of them.
#include "convert/moments/cells/morton_nodes.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/morton.h"

namespace vog::moments {
namespace {

/// Leaves on both sides of 0, in full blocks and alone, beside a tile of 128 voxels and one of 8.
std::vector<MortonNode> some_nodes() {
    std::mt19937 random(5);
    std::uniform_int_distribution<int> place(-9, 8), any(0, 3);
    std::vector<MortonNode> nodes;
    const auto add = [&](Vec3i origin, std::int32_t edge, bool tile) {
        for (const MortonNode& node : nodes)
            if (node.origin == origin) return;
        nodes.push_back({origin, edge, static_cast<std::uint32_t>(nodes.size()), tile});
    };
    for (int n = 0; n < 64; ++n) add(kLeafEdge * morton_place(n), kLeafEdge, false);
    for (int n = 0; n < 900; ++n)
        add(kLeafEdge * Vec3i{place(random), place(random), place(random)}, kLeafEdge,
            any(random) == 0);
    add({1 << 20, -(1 << 20), 8}, kLeafEdge, false);
    add({128, 0, 0}, 128, true);
    add({120, 0, 0}, kLeafEdge, false);
    std::ranges::sort(nodes, morton_less, &MortonNode::origin);
    return nodes;
}

TEST(leaf_neighbours, are_the_nodes_of_a_leafs_edge_around) {
    const std::vector<MortonNode> nodes = some_nodes();
    const LeafNeighbours neighbours(nodes);
    std::size_t found = 0;
    for (const MortonNode& node : nodes) {
        const LeafNeighbours::Around around = neighbours.around(node.origin);
        for (int n = 0; n < 27; ++n) {
            const Vec3i at = node.origin + kLeafEdge * Vec3i{n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1};
            const MortonNode* expected = nullptr;
            for (const MortonNode& other : nodes)
                if (other.origin == at && other.edge == kLeafEdge) expected = &other;
            EXPECT_EQ(around[static_cast<std::size_t>(n)], expected);
            found += expected != nullptr;
        }
    }
    EXPECT_GT(found, 5 * nodes.size());
}

TEST(leaf_neighbours, of_an_empty_volume_are_none) {
    const LeafNeighbours::Around around = LeafNeighbours({}).around({0, 0, 0});
    for (const MortonNode* node : around) EXPECT_EQ(node, nullptr);
}

}  // namespace
}  // namespace vog::moments
