// volume_partition.h: which leaves and tiles are in a part of a volume.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "vog/distributed.h"

namespace vog {

/// What dividing needs of a leaf or a tile.
struct PartNode {
    Vec3i origin;
    std::uint32_t voxels = 0;  ///< active ones, 512 for a tile
};
/// Which of these nodes, in any order, are in the part: their numbers, ascending.
[[nodiscard]] std::vector<std::uint32_t> nodes_of(std::span<const PartNode> nodes,
                                                  const VolumePart& part);

/// Which leaves and tiles are wanted: by the index of their first voxel and the voxels along an
/// edge.
using NodeChoice = std::function<bool(Vec3i origin, std::int32_t edge)>;
/// Those leaves and tiles of a volume, with its name, source and transform.
[[nodiscard]] Volume nodes_where(const Volume& volume, const NodeChoice& wanted);

}  // namespace vog
