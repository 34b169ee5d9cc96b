// slab_exchange.h: Pictures by depth slabs of models whose parts lie in several processes: sums over slabs have no order,
// and add over parts.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include "render/splat/volume/slab_picture.h"
#include "vog/distributed.h"

namespace vog::splat {

/// Depth of the middle Gaussian along the view, over the parts of all processes in their order.
/// size      receives the Gaussians of all parts
/// frame     relative to Gaussians::origin
double middle_depth(const Gaussians& part, const CameraFrame& frame, const Collective& processes,
                    std::size_t& size);

/// Range of depths of all parts.
DepthRange joint_depths(const DepthRange& own, const Collective& processes);

/// Draws the picture of all parts. Runs of tiles are summed by every process, sent to one process a tile, added there
/// in the order of processes, composited, and sent to the root.
/// drawn   this process's part; SlabView::depth and the slabs are those of all processes
/// image   [height * width] complete on the root
/// cost    memory: sends 64 MB at most, more for more than 2000 slabs of tiles
void draw_parts(const SlabPicture& drawn, tbb::enumerable_thread_specific<SlabBuffers>& buffers,
                const Collective& processes, Rgba* image);

}  // namespace vog::splat
