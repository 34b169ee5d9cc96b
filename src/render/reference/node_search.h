// node_search.h: Search of a NanoVDB grid for the leaves and tiles whose boxes pass a test.
#pragma once

#include "render/reference/hierarchical_dda.h"

namespace vog::reference {

/// Visits what passes the test inside an internal node.
template <class Node, class Near, class Visitor>
void search_node(const Node& node, Vec3d lower, const Near& near, Visitor& visitor) {
    using Child = typename Node::ChildNodeType;
    constexpr int kLog2Cells = static_cast<int>(Node::LOG2DIM);
    constexpr double kEdge = Child::DIM;
    const auto& data = *node.data();
    const auto for_each_near = [&](const auto& mask, const auto& visit) {
        for (auto on = mask.beginOn(); on; ++on) {
            const Vec3d at = cell_lower<kLog2Cells>(lower, kEdge, *on);
            if (near(at, Vec3d{kEdge, kEdge, kEdge})) visit(*on, at);
        }
    };
    for_each_near(data.mChildMask, [&](std::uint32_t offset, Vec3d at) {
        if constexpr (Child::LEVEL == 0)
            visitor.leaf(*data.getChild(offset), at);
        else
            search_node(*data.getChild(offset), at, near, visitor);
    });
    for_each_near(data.mValueMask, [&](std::uint32_t offset, Vec3d at) {
        if (!data.mChildMask.isOn(offset)) visitor.tile(at, kEdge, data.getValue(offset));
    });
}

/// Visits leaves and active tiles in an order of the grid alone:
///   visitor.leaf(const NanoLeaf&, Vec3d lower)
///   visitor.tile(Vec3d lower, double edge, float value)
/// near  called with the lower corner and the size of a box in local coordinates: whether to visit it, or
///       to search it; true of a box if true of any part of it
template <class Near, class Visitor>
void search(const RootCells& cells, const Near& near, Visitor&& visitor) {
    const std::vector<RootCells::Node>& nodes = cells.nodes();
    for (std::size_t n = 0; n < nodes.size();) {
        const RootCells::Node& node = nodes[n];
        if (!near(node.lower, node.upper - node.lower)) {
            n = node.skip;
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            const RootCell& cell = cells[i];
            if (!near(cell.lower, cell.upper - cell.lower)) continue;
            if (cell.child)
                search_node(*cell.child, cell.origin, near, visitor);
            else
                visitor.tile(cell.origin, double{NanoUpper::DIM}, cell.value);
        }
        ++n;
    }
}

}  // namespace vog::reference
