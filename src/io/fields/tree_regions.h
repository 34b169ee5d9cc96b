// tree_regions.h: cubes of one value that an OpenVDB tree has inside a box of voxels.
#pragma once

#include <openvdb/openvdb.h>

namespace vog::field_files {

/// Calls visit(box, value, active) for tiles and voxels of a node inside a box until it returns
/// false.
/// returns  whether it never did
template <class Node, class Visit>
bool for_each_region_of(const Node& node, const openvdb::CoordBBox& box, const Visit& visit) {
    using openvdb::Coord;
    using openvdb::CoordBBox;
    CoordBBox inside = box;
    inside.intersect(node.getNodeBoundingBox());
    constexpr int kShift = [] {
        if constexpr (Node::LEVEL == 0)
            return 0;
        else
            return static_cast<int>(Node::ChildNodeType::TOTAL);
    }();
    const Coord first(inside.min().x() >> kShift, inside.min().y() >> kShift,
                      inside.min().z() >> kShift);
    const Coord last(inside.max().x() >> kShift, inside.max().y() >> kShift,
                     inside.max().z() >> kShift);
    for (int x = first.x(); x <= last.x(); ++x)
        for (int y = first.y(); y <= last.y(); ++y)
            for (int z = first.z(); z <= last.z(); ++z) {
                const Coord at(x << kShift, y << kShift, z << kShift);
                const openvdb::Index n = Node::coordToOffset(at);
                if constexpr (Node::LEVEL == 0) {
                    if (!visit(CoordBBox(at, at), node.getValue(n), node.isValueOn(n)))
                        return false;
                } else {
                    if (node.isChildMaskOn(n)) {
                        if (!for_each_region_of(*node.getTable()[n].getChild(), inside, visit))
                            return false;
                        continue;
                    }
                    CoordBBox cell = CoordBBox::createCube(at, 1 << kShift);
                    cell.intersect(inside);
                    if (!visit(cell, node.getTable()[n].getValue(), node.isValueMaskOn(n)))
                        return false;
                }
            }
    return true;
}

/// Calls visit(box, value, active) for every tile and voxel of a tree inside a box, and once with an
/// empty box for space without nodes beyond, until it returns false.
/// returns  whether it never did
/// cost     O(nodes and voxels in the box); O(entries of the root) for boxes of many root cells
template <class Tree, class Visit>
bool for_each_region(const Tree& tree, const openvdb::CoordBBox& box, const Visit& visit) {
    using openvdb::Coord;
    using openvdb::CoordBBox;
    using Child = typename Tree::RootNodeType::ChildNodeType;
    const auto& root = tree.root();
    const auto cell_of = [](const Coord& index) {
        return Coord(index.x() >> Child::TOTAL, index.y() >> Child::TOTAL,
                     index.z() >> Child::TOTAL);
    };
    const CoordBBox cells(cell_of(box.min()), cell_of(box.max()));
    // Found by their places: with 100,000 tiles in both, each looks at few of the others.
    constexpr std::uint64_t kFewCells = 64;
    if (cells.volume() <= kFewCells) {
        for (auto cell = cells.begin(); cell; ++cell) {
            const Coord at((*cell).x() << Child::TOTAL, (*cell).y() << Child::TOTAL,
                           (*cell).z() << Child::TOTAL);
            if (const Child* child = root.template probeConstNode<Child>(at)) {
                if (!for_each_region_of(*child, box, visit)) return false;
                continue;
            }
            CoordBBox inside = CoordBBox::createCube(at, static_cast<int>(Child::DIM));
            inside.intersect(box);
            if (!visit(inside, root.getValue(at), root.isValueOn(at))) return false;
        }
        return true;
    }
    std::uint64_t found = 0;
    for (auto child = root.cbeginChildOn(); child; ++child) {
        if (!child->getNodeBoundingBox().hasOverlap(box)) continue;
        ++found;
        if (!for_each_region_of(*child, box, visit)) return false;
    }
    for (auto tile = root.cbeginValueAll(); tile; ++tile) {
        CoordBBox inside = CoordBBox::createCube(tile.getCoord(), static_cast<int>(Child::DIM));
        if (!inside.hasOverlap(box)) continue;
        ++found;
        inside.intersect(box);
        if (!visit(inside, *tile, tile.isValueOn())) return false;
    }
    return found == cells.volume() || visit(CoordBBox(), root.background(), false);
}

}  // namespace vog::field_files
