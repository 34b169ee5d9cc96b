// moment_nodes.cpp: Morton order without keys.
#include "convert/moment_nodes.h"

#include <tbb/parallel_sort.h>

#include <cmath>

namespace vog {

namespace {

/// Whether the highest set bit of a lies below that of b.
bool lower_bit(std::uint32_t a, std::uint32_t b) { return a < b && a < (a ^ b); }

}  // namespace

bool morton_less(Vec3i a, Vec3i b) {
    // The axis whose coordinates differ in the highest bit decides; flipping the sign bit orders
    // negative indices before positive ones.
    constexpr std::uint32_t kSign = 0x80000000u;
    int decides = 0;
    std::uint32_t highest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::uint32_t difference =
            static_cast<std::uint32_t>(a[axis]) ^ static_cast<std::uint32_t>(b[axis]);
        if (lower_bit(highest, difference)) {
            highest = difference;
            decides = axis;
        }
    }
    return (static_cast<std::uint32_t>(a[decides]) ^ kSign) <
           (static_cast<std::uint32_t>(b[decides]) ^ kSign);
}

Moments cell_moments(const MomentCell& cell, int edge_log2) {
    Moments moments;
    moments.mass = cell.mass;
    moments.mean =
        vec_cast<double>(cell.mean) + cube_center(cell.origin, std::ldexp(1.0, edge_log2));
    for (std::size_t n = 0; n < 6; ++n) moments.covariance[n] = cell.covariance[n];
    return moments;
}

std::vector<MomentNode> morton_nodes(const Volume& volume) {
    std::vector<MomentNode> nodes;
    nodes.reserve(volume.leaves.size() + volume.tiles.size());
    for (std::size_t n = 0; n < volume.leaves.size(); ++n)
        nodes.push_back({volume.leaves[n].origin, kLeafEdge, static_cast<std::uint32_t>(n), false});
    for (std::size_t n = 0; n < volume.tiles.size(); ++n)
        nodes.push_back(
            {volume.tiles[n].origin, volume.tiles[n].edge, static_cast<std::uint32_t>(n), true});
    tbb::parallel_sort(nodes.begin(), nodes.end(), [](const MomentNode& a, const MomentNode& b) {
        return morton_less(a.origin, b.origin);
    });
    return nodes;
}

}  // namespace vog
