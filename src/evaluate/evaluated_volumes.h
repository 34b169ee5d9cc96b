// evaluated_volumes.h: statistics of the evaluated data: voxels, boxes, mass; summed over
// processes.
#pragma once

#include <cstdint>
#include <span>

#include "vog/distributed.h"
#include "vog/evaluate.h"

namespace vog::evaluation {

/// Sums a count over all processes; exact, as counts are below 2^53.
void allreduce_sum(const Collective& collective, std::uint64_t& count);
/// Bounding box of the volumes of all processes, world units.
Box box_of(std::span<const Volume> volumes, const Collective& collective);
/// An evaluation with data and settings filled in, without views and rows.
Evaluation begin_evaluation(std::span<const Volume> volumes, const EvaluateOptions& options);

}  // namespace vog::evaluation
