// bricks.cpp: moment sums of the cells inside a leaf or a tile.
#include "convert/moments/cells/bricks.h"

#include <algorithm>

#include "core/parallel.h"

namespace vog::moments {

BigVector<Brick> volume_bricks(const Volume& volume, const std::vector<MortonNode>& nodes) {
    BigVector<Brick> bricks;
    bricks.reserve(nodes.size());
    for (const MortonNode& node : nodes) {
        check_interrupt();
        Brick brick{node.origin, 1, nullptr, 0};
        if (node.tile) {
            brick.value = volume.tiles[node.index].value;
            brick.spacing = static_cast<double>(node.edge) / kLeafEdge;
            if (brick.value <= 0) continue;
        } else {
            brick.leaf = &volume.leaves[node.index];
            if (std::none_of(brick.leaf->value.begin(), brick.leaf->value.end(),
                             [](float value) { return value > 0; }))
                continue;
        }
        bricks.push_back(brick);
    }
    return bricks;
}

namespace {

/// Converts lengths from samples to voxels.
void scale(MomentSums& sums, double spacing) {
    const double volume = spacing * spacing * spacing;
    sums.mass *= volume;
    sums.first = volume * spacing * sums.first;
    for (double& second : sums.second) second *= volume * spacing * spacing;
}

}  // namespace

BrickSums brick_sums(const Brick& brick) {
    BrickSums sums;
    if (brick.leaf) {
        sums.twos = leaf_sums(*brick.leaf);
        sums.fours = merge_eight<2>(sums.twos);
        sums.whole = merge_eight<4>(sums.fours)[0];
        if (brick.spacing == 1) return sums;
        scale(sums.whole, brick.spacing);
        for (MomentSums& cell : sums.fours) scale(cell, brick.spacing);
        for (MomentSums& cell : sums.twos) scale(cell, brick.spacing);
        return sums;
    }
    const auto cube = [&](double samples) {
        const double edge = samples * brick.spacing;
        return cube_sums(brick.value * edge * edge * edge, edge);
    };
    sums.whole = cube(8);
    sums.fours.fill(cube(4));
    sums.twos.fill(cube(2));
    return sums;
}

Moments brick_node(const Brick& brick, const BrickSums& sums, std::size_t n) {
    MomentSums cell;
    int edge = 8, morton = 0;
    if (n == 0) {
        cell = sums.whole;
    } else if (n < 9) {
        edge = 4, morton = static_cast<int>(n - 1);
        cell = sums.fours[n - 1];
    } else if (n < kBrickNodes) {
        edge = 2, morton = static_cast<int>(n - 9);
        cell = sums.twos[n - 9];
    } else {
        edge = 1, morton = static_cast<int>(n - kBrickNodes);
        const Vec3i place = morton_place(morton);
        cell =
            cube_sums(brick.sample(leaf_offset(place.x, place.y, place.z)) * brick.sample_volume(),
                      brick.spacing);
    }
    if (!(cell.mass > 0)) return {};
    Moments moments = moments_of(cell);
    moments.mean = moments.mean + brick_cell_center(brick, morton, edge);
    return moments;
}

}  // namespace vog::moments
