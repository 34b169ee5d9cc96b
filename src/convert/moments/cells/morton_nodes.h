// morton_nodes.h: the leaves and tiles of a volume in Morton order, where cells of every power of
// two are contiguous.
#pragma once

#include <cstdint>
#include <vector>

#include "convert/moments/gaussian_moments.h"
#include "core/morton.h"
#include "vog/volume.h"

namespace vog::moments {

struct MortonNode {
    Vec3i origin;
    std::int32_t edge = kLeafEdge;
    std::uint32_t index = 0;  ///< into the volume's leaves or tiles
    bool tile = false;
};

/// Every leaf and tile, sorted.
std::vector<MortonNode> morton_nodes(const Volume& volume);

/// Centre of the cube of `edge` voxels from `origin` on, in index space.
inline Vec3d cube_center(Vec3i origin, double edge) {
    const double half = 0.5 * (edge - 1);
    return vec_cast<double>(origin) + Vec3d{half, half, half};
}

/// Leaves go to threads in runs of this many: results are joined in the order of the runs.
inline constexpr std::size_t kNodeChunk = 128;

}  // namespace vog::moments
