// evaluated_volumes.h: what an evaluation is of: voxels, boxes and mass of all parts
// (vog/distributed.h).
#pragma once

#include <cstdint>
#include <span>

#include "vog/distributed.h"
#include "vog/evaluate.h"

namespace vog::evaluation {

/// Counts are exact in doubles.
void add_up(const Collective& collective, std::uint64_t& count);
/// The box around the volumes, of all parts.
Box box_of(std::span<const Volume> volumes, const Collective& collective);
/// What the evaluation is of and how it is made: all but its views and rows.
Evaluation begin_evaluation(std::span<const Volume> volumes, const EvaluateOptions& options);

}  // namespace vog::evaluation
