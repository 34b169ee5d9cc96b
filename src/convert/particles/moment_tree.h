// moment_tree.h: particles, or the Gaussians of a model, as a tree of moments, and cuts through it.
// Each has a mass and a covariance of its own. A node is cut in two at its mean, across the longest
// axis of its covariance. Cells of an octree know nothing of the halos and filaments they cut: at
// 8:1 they are worth 2.9 dB less (docs/particles.md).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "convert/moments/gaussian_moments.h"
#include "data/point_grid.h"

namespace vog::particles {

using namespace moments;

/// A particle as the tree sees it.
struct Particle {
    Vec3d place;                        ///< voxels from the grid's origin
    float mass = 0;                     ///< > 0
    std::array<float, 6> covariance{};  ///< xx xy xz yy yz zz, voxels squared
};
Moments particle_moments(const Particle& particle);

/// Two particles or more.
struct PointNode {
    std::uint32_t first = 0, middle = 0, last = 0;  ///< its particles, and where they are parted
    std::uint32_t first_child = 0;                  ///< of those halves that are nodes themselves
    float mass = 0;
    Vec3f mean;                         ///< from the place of its first particle, voxels
    std::array<float, 6> covariance{};  ///< xx xy xz yy yz zz
    float gain = 0;                     ///< what splitting it is worth
};

struct PointTree {
    BigVector<Particle> particles;            ///< a node's are contiguous
    BigVector<PointNode> nodes;               ///< root first, parents before children; none for one
    std::vector<std::size_t> generations{0};  ///< where each begins, and the end
};

/// The same for any number of threads.
/// cost  O(N log N) time, 120 bytes a particle
PointTree point_tree(BigVector<Particle> particles);

/// At most `budget` nodes and particles, in the order of the tree; means in voxels from the grid's
/// origin.
BigVector<Moments> best_cut(const PointTree& tree, std::size_t budget);

}  // namespace vog::particles
