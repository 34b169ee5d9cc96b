// brick_tree.h: bricks that a box overlaps: bounding boxes of 4, 16, ... bricks that follow each other in Morton order.
// The time follows the bricks that are there, near or far from each other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "convert/moments/cells/bricks.h"

namespace vog::moments {

/// Box of whole voxels, both ends inclusive.
struct VoxelBox {
    Vec3i first, last;
    bool overlaps(const VoxelBox& o) const {
        // Without branches, which nothing would predict.
        return bool((first.x <= o.last.x) & (o.first.x <= last.x) & (first.y <= o.last.y) &
                    (o.first.y <= last.y) & (first.z <= o.last.z) & (o.first.z <= last.z));
    }
};
/// Voxels that a box touches, index space; voxel 0 is [-1/2, 1/2). Limited to the range of indices.
VoxelBox voxel_box(Vec3d lower, Vec3d upper);

class BrickTree {
  public:
    /// bricks  in Morton order
    explicit BrickTree(std::span<const Brick> bricks);
    /// Calls take(brick) for the bricks `begin` to `end` that the box overlaps, in ascending order.
    /// begin  a multiple of end - begin rounded up to a power of two
    template <class Take>
    void for_each(const VoxelBox& box, std::size_t begin, std::size_t end, const Take& take) const {
        std::size_t level = 0;
        while (level + 1 < levels_.size() && bricks_at(level + 1) <= end - begin) ++level;
        const std::size_t bricks = bricks_at(level);
        for (std::size_t node = begin / bricks; node * bricks < end; ++node)
            visit(level, node, box, take);
    }

  private:
    /// Four: with eight, a step of dense data takes 4 % longer, with two 15 %.
    static constexpr std::size_t kLog2Children = 2;
    /// Bricks of a node.
    static std::size_t bricks_at(std::size_t level) {
        return std::size_t{1} << (kLog2Children * level);
    }
    template <class Take>
    void visit(std::size_t level, std::size_t node, const VoxelBox& box, const Take& take) const {
        if (!levels_[level][node].overlaps(box)) return;
        if (level == 0) {
            take(static_cast<std::uint32_t>(node));
            return;
        }
        const std::size_t first = node << kLog2Children;
        const std::size_t end =
            std::min(first + (std::size_t{1} << kLog2Children), levels_[level - 1].size());
        for (std::size_t child = first; child < end; ++child) visit(level - 1, child, box, take);
    }

    std::vector<std::vector<VoxelBox>> levels_;  ///< of bricks, of four bricks, of sixteen, ...
};

}  // namespace vog::moments
