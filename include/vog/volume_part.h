// vog/volume_part.h: a volume shared out among processes, or taken piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "vog/volume.h"

namespace vog {

/// One of `count` parts: leaves and tiles in Morton order are cut into runs of about as many active
/// voxels (a tile counts as a leaf), and this is run `index`. Parts are disjoint, together the
/// whole, and may be empty: where there are fewer cubes than parts.
struct VolumePart {
    int index = 0, count = 1;
    int align_voxels = 8;  ///< runs begin where aligned cubes of this edge do; a power of two, >= 8

    bool whole() const { return count == 1; }
};
/// throws vog::Error for a count below 1, an index outside, an edge that is no power of two
void validate(const VolumePart& part);

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

/// A part of a volume, with its name, source and transform. Its box is its own: views of the whole
/// are taken of the whole's. throws vog::Error as validate() does
[[nodiscard]] Volume part_of(const Volume& volume, const VolumePart& part);

}  // namespace vog
