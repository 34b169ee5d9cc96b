// evaluated_volumes.h: statistics of the evaluated data: voxels, boxes, mass; summed over
// processes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "vog/distributed.h"
#include "vog/evaluate.h"
#include "vog/scene.h"

namespace vog::evaluation {

/// Sums a count over all processes; exact, as counts are below 2^53.
void allreduce_sum(const Collective& collective, std::uint64_t& count);
/// Bounding box of the volumes of all processes, world units.
Box box_of(std::span<const Volume> volumes, const Collective& collective);
/// Scene of voxels or a model of a box, all of which outlive it. Its pictures state their views.
Scene scene_in(const Box& box, VoxelSource voxels, const Collective* collective = nullptr);
Scene scene_in(const Box& box, const Gaussians& model, const Collective* collective = nullptr);
/// Pointer to something that outlives it.
template <class T>
std::shared_ptr<const T> borrowed(const T& lasting) {
    return {std::shared_ptr<void>{}, &lasting};
}
/// An evaluation with data and settings filled in, without views and rows.
Evaluation begin_evaluation(std::span<const Volume> volumes, const EvaluateOptions& options);

}  // namespace vog::evaluation
