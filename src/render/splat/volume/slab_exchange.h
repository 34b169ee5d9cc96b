// slab_exchange.h: Pictures by depth slabs of models whose parts lie in several processes: sums over slabs have no order,
// and add over parts.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <functional>
#include <span>

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

/// A process's part of a model. SlabView::depth and the slabs are those of all processes.
struct SlabPart {
    const SlabPicture* drawn;
    tbb::enumerable_thread_specific<SlabBuffers>* buffers;
};

/// Makes pixels of the sums of cell n of tile t, which the thread's buffers of each model have, and sets these to 0.
using FinishCell = std::function<void(int t, int n)>;

/// Draws the picture of all parts. Runs of tiles are summed by every process, sent to one process a tile, added there
/// in the order of processes, finished, and sent to the root.
/// models      at least one, of one camera
/// finish      for tiles of this process, in any thread
/// everywhere  finishes cells that no Gaussian meets, too
/// image       [height * width] complete on the root
/// cost        memory: sends 64 MB at most, more for more than 2000 slabs of tiles
void draw_parts(std::span<const SlabPart> models, const Collective& processes,
                const FinishCell& finish, bool everywhere, Rgba* image);

}  // namespace vog::splat
