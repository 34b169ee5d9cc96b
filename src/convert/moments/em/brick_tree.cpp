// brick_tree.cpp: bounding boxes of bricks, level by level.
#include "convert/moments/em/brick_tree.h"

#include <cmath>
#include <limits>

namespace vog::moments {

VoxelBox voxel_box(Vec3d lower, Vec3d upper) {
    using Limits = std::numeric_limits<std::int32_t>;
    const auto voxel_at = [](double index) {
        return static_cast<std::int32_t>(
            std::clamp(std::floor(index + 0.5), double{Limits::min()}, double{Limits::max()}));
    };
    return {{voxel_at(lower.x), voxel_at(lower.y), voxel_at(lower.z)},
            {voxel_at(upper.x), voxel_at(upper.y), voxel_at(upper.z)}};
}

BrickTree::BrickTree(std::span<const Brick> bricks) {
    std::vector<VoxelBox>& boxes = levels_.emplace_back();
    boxes.reserve(bricks.size());
    for (const Brick& brick : bricks) {
        const Vec3i o = brick.origin;
        const auto within = static_cast<std::int32_t>(brick.spacing * kLeafEdge) - 1;
        boxes.push_back({o, o + Vec3i{within, within, within}});
    }
    while (levels_.back().size() > 1) {
        const std::vector<VoxelBox>& below = levels_.back();
        std::vector<VoxelBox> above;
        for (std::size_t n = 0; n < below.size(); ++n) {
            if (n >> kLog2Children == above.size()) above.push_back(below[n]);
            VoxelBox& box = above.back();
            for (int axis = 0; axis < 3; ++axis) {
                box.first[axis] = std::min(box.first[axis], below[n].first[axis]);
                box.last[axis] = std::max(box.last[axis], below[n].last[axis]);
            }
        }
        levels_.push_back(std::move(above));
    }
}

}  // namespace vog::moments
