// mean_octree.h: octree over the means of a model's Gaussians.
#pragma once

#include <cstddef>
#include <vector>

#include "vog/lod.h"

namespace vog::lod {

/// Most children of a node. Cells with no more Gaussians are not divided: their nodes would cost
/// more than they save.
inline constexpr std::uint32_t kMostChildren = 8;

/// Nodes by level, without Gaussians of their own.
struct MeanOctree {
    Hierarchy hierarchy;              ///< counts of children; error: half the edge of the cell
    std::vector<std::size_t> levels;  ///< index of each level's first node, and the end
};
/// Builds the octree and reorders the Gaussians by it.
MeanOctree mean_octree(Gaussians& model, const HierarchyOptions& options);

}  // namespace vog::lod
