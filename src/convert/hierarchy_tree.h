// hierarchy_tree.h: which Gaussians of a model belong together: an octree over the means.
#pragma once

#include "vog/hierarchy.h"

namespace vog {

/// Cells with no more Gaussians than this are not divided: a node is to save more than it costs.
inline constexpr std::uint32_t kMostChildren = 8;

/// Puts the Gaussians into the order of the tree; fills first and count, and half the edges
/// of the cells as errors.
Hierarchy hierarchy_tree(Gaussians& model, const HierarchyOptions& options);

}  // namespace vog
