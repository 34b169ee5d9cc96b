// volume_partition.h: selection of the leaves and tiles in one part of a volume.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "vog/distributed.h"

namespace vog {

/// Leaf or tile as an item of the partition.
struct PartNode {
    Vec3i origin;              ///< index of the first voxel
    std::uint32_t voxels = 0;  ///< weight: active voxels, 512 for a tile
};
/// Positions in `nodes` of those in the part, ascending.
/// nodes  in any order
[[nodiscard]] std::vector<std::uint32_t> nodes_of(std::span<const PartNode> nodes,
                                                  const VolumePart& part);

/// Predicate on leaves and tiles: index of the first voxel, edge in voxels.
using NodeChoice = std::function<bool(Vec3i origin, std::int32_t edge)>;
/// Volume of the selected leaves and tiles, with the same name, source and transform.
[[nodiscard]] Volume nodes_where(const Volume& volume, const NodeChoice& selected);

}  // namespace vog
