// moment_tree.h: binary tree of moments over particles or the Gaussians of a model, and its
// prunings.
// Nodes are split at their mean, across the axis of largest variance, which follows halos and
// filaments. Cells of an octree have 2.9 dB less PSNR at 8:1 (docs/particles.md). Or at the middle of their box, for particles that fill
// space: alike cells side by side, whose ripples cancel along a ray.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "convert/moments/gaussian_moments.h"
#include "data/point_grid.h"

namespace vog::particles {

using namespace moments;

/// A particle: a mass distribution of its own.
struct Particle {
    Vec3d place;                        ///< relative to the grid's origin, voxels
    float mass = 0;                     ///< > 0
    std::array<float, 6> covariance{};  ///< xx xy xz yy yz zz, voxels squared
    std::uint32_t index = 0;            ///< place in the owner's list, before any sorting
};
Moments particle_moments(const Particle& particle);

/// Two or more particles.
struct PointNode {
    std::uint32_t first = 0, middle = 0, last = 0;  ///< particles [first, last), split at middle
    std::uint32_t first_child = 0;                  ///< first of up to two sides that are nodes
    float mass = 0;
    Vec3f mean;                         ///< relative to the first particle, voxels
    std::array<float, 6> covariance{};  ///< xx xy xz yy yz zz
    float gain = 0;                     ///< split_gain of the two sides
};

/// Where nodes are split.
enum class Division { at_mean, at_middle };
struct PointBox {
    Vec3f lower, upper;  ///< voxels
};

struct PointTree {
    BigVector<Particle> particles;  ///< the particles of a node are contiguous
    BigVector<PointNode> nodes;     ///< root first, then by generation; none for one particle
    BigVector<PointBox> boxes;      ///< [nodes] with Division::at_middle: halves of the parent's
    std::vector<std::size_t> generations{0};  ///< index of each one's first node, and the end
};

/// Builds the tree: the same for any number of threads.
/// cost  O(N log N) time, 120 bytes a particle
PointTree point_tree(BigVector<Particle> particles, Division division = Division::at_mean);

/// Optimal pruning with at most `budget` leaves (lagrange_search.h): moments of nodes and particles
/// in the order of the tree, means in voxels relative to the grid's origin. Of a tree with boxes, nodes have the moments of windows over
/// these, the start of soften().
/// ends  receives for each cell the index behind its last particle in tree.particles; null: not needed
BigVector<Moments> best_cut(const PointTree& tree, std::size_t budget,
                            BigVector<std::uint32_t>* ends = nullptr);

}  // namespace vog::particles
