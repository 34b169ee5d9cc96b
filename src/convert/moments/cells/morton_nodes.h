// morton_nodes.h: leaves and tiles of a volume in Morton order, in which the nodes of any aligned
// cube are contiguous.
#pragma once

#include <cstdint>
#include <vector>

#include "convert/moments/gaussian_moments.h"
#include "core/morton.h"
#include "vog/volume.h"

namespace vog::moments {

/// A leaf or a tile.
struct MortonNode {
    Vec3i origin;
    std::int32_t edge = kLeafEdge;
    std::uint32_t index = 0;  ///< into the volume's leaves or tiles
    bool tile = false;
};

/// All leaves and tiles, sorted.
std::vector<MortonNode> morton_nodes(const Volume& volume);

/// Centre in index space of the cube of `edge` voxels whose first voxel is `origin`.
inline Vec3d cube_center(Vec3i origin, double edge) {
    const double half = 0.5 * (edge - 1);
    return vec_cast<double>(origin) + Vec3d{half, half, half};
}

/// Nodes per parallel task. Results are concatenated in the order of tasks: the same bytes for any
/// number of threads.
inline constexpr std::size_t kNodeChunk = 128;

}  // namespace vog::moments
