// mean_octree.h: which Gaussians of a model belong together: an octree over the means.
#pragma once

#include <cstddef>
#include <vector>

#include "vog/lod.h"

namespace vog::lod {

/// Cells with no more Gaussians than this are not divided: a node is to save more than it costs.
inline constexpr std::uint32_t kMostChildren = 8;

struct MeanOctree {
    Hierarchy hierarchy;              ///< counts, and half the edges of the cells as errors
    std::vector<std::size_t> levels;  ///< first node of each, and where the last one ends
};
/// Puts the Gaussians into the order of the tree.
MeanOctree mean_octree(Gaussians& model, const HierarchyOptions& options);

}  // namespace vog::lod
