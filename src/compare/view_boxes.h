// view_boxes.h: boxes that error views look at: of all but a thousandth of the mass, of the heaviest
// blocks of voxels.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "vog/camera.h"
#include "vog/distributed.h"
#include "vog/volume.h"

namespace vog::comparison {

/// Box around all but a thousandth of the masses of boxes, or `whole` unless more than twice as
/// large.
/// for_each  calls its argument with each box and its mass
Box box_of_mass(
    const Box& whole, const Collective& collective,
    const std::function<void(const std::function<void(const Box&, double)>&)>& for_each);

/// Views of the blocks of 128^3 voxels with the most mass, each as many of the twelve as its mass
/// earns (D'Hondt's method). Their pixels are about a voxel wide.
struct BlockViews {
    std::vector<Camera> cameras;
    std::size_t viewed = 0, blocks = 0;
    double mass_share = 0;  ///< of the viewed blocks
    double radius = 0;      ///< of the largest of them, world units
};
BlockViews views_of_heaviest_blocks(std::span<const Volume> volumes);

}  // namespace vog::comparison
