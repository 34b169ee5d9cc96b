// bricks.h: blocks of 8^3 samples, from a leaf or a tile, and the moments of the cells inside them.
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

/// 8^3 boxes of constant density, `spacing` voxels wide. A tile has one value, so a sample of it is
/// an eighth of its edge wide whatever its size.
struct Brick {
    Vec3i origin;        ///< index of the first voxel
    double spacing = 1;  ///< voxels: 1 for leaves and small tiles
    const Leaf* leaf = nullptr;
    float value = 0;  ///< density of every sample, if leaf is null
    /// Edge of the data's voxels, in units of the index space: less than that of samples in a tile, more in a brick that
    /// was divided.
    double voxel = 1;

    float sample(int n) const { return leaf ? leaf->value[static_cast<std::size_t>(n)] : value; }
    /// Voxels per sample.
    double sample_volume() const { return spacing * spacing * spacing; }
};

/// One brick for each node with mass, in Morton order.
BigVector<Brick> volume_bricks(const Volume& volume, const std::vector<MortonNode>& nodes);

/// Sums of the cells of 8, 4 and 2 samples inside a brick, each about its own centre; lengths in
/// voxels. Cells of one sample follow from Brick::sample.
struct BrickSums {
    MomentSums whole;
    std::array<MomentSums, 8> fours;
    std::array<MomentSums, 64> twos;
};
BrickSums brick_sums(const Brick& brick);

/// Nodes above the samples in a brick's octree: 0 the whole, 1-8 cells of 4 samples, 9-72 of 2. The
/// 512 samples are nodes 73-584; children of n are 8 n + 1 ... 8 n + 8, in Morton order.
inline constexpr std::size_t kBrickNodes = 73;

/// Centre of a cell in index space.
/// morton  number of the cell in Morton order
/// edge    of the cell, samples
inline Vec3d brick_cell_center(const Brick& brick, int morton, int edge) {
    const Vec3d first = cube_center(brick.origin, 1);  // centre of the first voxel
    const Vec3d place = vec_cast<double>(morton_place(morton));
    const double half = 0.5 * (edge * brick.spacing - 1);
    return first + Vec3d{half, half, half} + (edge * brick.spacing) * place;
}

/// Moments of node n of a brick's octree, mean in index space; mass 0 if the cell is empty.
Moments brick_node(const Brick& brick, const BrickSums& sums, std::size_t n);

}  // namespace vog::moments
