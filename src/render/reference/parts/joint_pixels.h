// joint_pixels.h: Pictures of several processes that each have a part of the voxels, a run of pixels at a time: what the
// processes send is bounded, whatever the size of the picture.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "render/reference/fields/field_moments.h"
#include "render/reference/reference.h"
#include "vog/distributed.h"
#include "vog/progress.h"

namespace vog::reference {

/// Processes of a picture; null where this one has all voxels.
inline const Collective* processes_of(const ReferenceOptions& options) {
    return options.collective && options.collective->count > 1 ? options.collective : nullptr;
}

/// Calls run(first, count) for consecutive runs of `most` of some items, one after another on this thread, the only one
/// that may call the operations of a Collective.
template <class Run>
void for_each_run(std::size_t items, std::size_t most, const Progress& progress, const Run& run) {
    for (std::size_t first = 0; first < items; first += most) {
        const std::size_t count = std::min(most, items - first);
        run(first, count);
        if (progress) progress(static_cast<double>(first + count) / static_cast<double>(items));
    }
}

/// Replaces sums of this process's voxels on each pixel by those of all, the same in each process.
void join(std::span<FirstRelative> pixels, const Collective& processes);

}  // namespace vog::reference
