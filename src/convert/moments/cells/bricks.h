// bricks.h: leaves and tiles as one thing: 8^3 samples, a tile's of an eighth of its edge.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "convert/moments/cells/morton_nodes.h"
#include "convert/moments/gaussian_moments.h"
#include "vog/memory.h"
#include "vog/volume.h"

namespace vog::moments {

/// 8^3 box-shaped samples of constant density, `spacing` voxels wide. A tile larger than a leaf is
/// sampled that coarsely: inside it there is nothing to see.
struct Brick {
    Vec3i origin;        ///< index of its first voxel
    double spacing = 1;  ///< voxels: 1 for leaves and small tiles
    const Leaf* leaf = nullptr;
    float value = 0;  ///< of every sample, where there is no leaf

    float sample(int n) const { return leaf ? leaf->value[static_cast<std::size_t>(n)] : value; }
    /// Voxels in a sample.
    double sample_volume() const { return spacing * spacing * spacing; }
};

/// Bricks with mass, in Morton order: one for each node.
BigVector<Brick> volume_bricks(const Volume& volume, const std::vector<MortonNode>& nodes);

/// All cells inside a brick, levels of 8, 4, 2 and 1 samples; the last is left to `sample`.
/// Sums about each cell's centre, in index units.
struct BrickSums {
    MomentSums whole;
    std::array<MomentSums, 8> fours;
    std::array<MomentSums, 64> twos;
};
BrickSums brick_sums(const Brick& brick);

/// The cells of a brick as one tree: node 0 the whole, 1-8 its fours, 9-72 their twos, and 512
/// samples from 73 on; children of n are 8 n + 1 ... 8 n + 8, in Morton order.
inline constexpr std::size_t kBrickNodes = 73;

/// Centre of the cell `place` (Morton, in cells) of `edge` samples, in index space.
inline Vec3d brick_cell_center(const Brick& brick, int morton, int edge) {
    const Vec3d first = cube_center(brick.origin, 1);  // centre of the first voxel
    const Vec3d place = vec_cast<double>(morton_place(morton));
    const double half = 0.5 * (edge * brick.spacing - 1);
    return first + Vec3d{half, half, half} + (edge * brick.spacing) * place;
}

/// Moments of node n of a brick's tree, mean as an index; mass 0 where the cell is empty.
Moments brick_node(const Brick& brick, const BrickSums& sums, std::size_t n);

}  // namespace vog::moments
