// hierarchy_links.h: the order in which the nodes and leaves of a hierarchy lie.
#pragma once

#include <cstddef>
#include <string>

#include "vog/lod.h"

namespace vog {

/// Fills first_node and first_leaf from the counts: the roots are the first nodes, then come the
/// children of all nodes in the order of their parents, and so do leaves; leaves of no node are
/// the last.
/// throws  vog::Error naming `where` if the counts are not those of a forest over `leaves`
void link(Hierarchy& hierarchy, std::size_t leaves, const std::string& where);
/// Whether it lies as link() has it: what build_hierarchy makes, and a file holds.
bool in_one_order(const Hierarchy& hierarchy);

}  // namespace vog
