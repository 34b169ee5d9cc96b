// hierarchy_links.h: breadth-first order of the nodes and leaves of a hierarchy.
#pragma once

#include <cstddef>
#include <string>

#include "vog/lod.h"

namespace vog {

/// Computes first_node and first_leaf from the counts, in breadth-first order: nodes are the roots,
/// then the children of each node in turn; leaves are in the order of their parents, those without
/// a parent last.
/// throws  vog::Error naming `where` if the counts do not form a forest over `leaves` Gaussians
void link(Hierarchy& hierarchy, std::size_t leaves, const std::string& where);
/// Whether nodes and leaves are in the order of link(), as build_hierarchy and files have them.
bool in_one_order(const Hierarchy& hierarchy);

}  // namespace vog
