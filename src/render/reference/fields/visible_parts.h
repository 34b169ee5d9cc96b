// visible_parts.h: levels of a mesh as volumes that do not overlap, with their fields.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "vog/levels.h"
#include "vog/voxel_field.h"

namespace vog::reference {

/// Index of the first node whose origin is not before this one, among nodes sorted by origin.
template <class Nodes>
std::size_t index_of(const Nodes& nodes, Vec3i origin) {
    const auto found =
        std::lower_bound(nodes.begin(), nodes.end(), origin, [](const auto& node, Vec3i at) {
            return std::tie(node.origin.x, node.origin.y, node.origin.z) <
                   std::tie(at.x, at.y, at.z);
        });
    return static_cast<std::size_t>(found - nodes.begin());
}

/// Visible voxels of each level and the fields at them.
struct VisibleParts {
    std::vector<Volume> volumes;
    std::vector<VoxelField> fields;  ///< [volumes]
};
/// One ray through these parts has all sums at once, where levels themselves need a pass for each moment.
/// fields   [levels.volumes]
/// returns  none if a voxel is hidden in part
std::optional<VisibleParts> visible_parts(const Levels& levels, std::span<const VoxelField> fields);
/// The same, where partly hidden voxels have their density times the share that is seen.
VisibleParts weighted_parts(const Levels& levels, std::span<const VoxelField> fields);

}  // namespace vog::reference
