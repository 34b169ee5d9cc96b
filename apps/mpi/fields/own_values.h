// own_values.h: fields of a distributed model: its volumes' own values.
#pragma once

#include <optional>
#include <span>

#include "model_file.h"
#include "ranks.h"
#include "shared/convert_run.h"
#include "vog/convert_moments.h"

namespace vog::mpi {

/// Adds the volumes' own values to this rank's Gaussians of every input, with the ranges of all ranks, and
/// describes them in the header. Uniform hard cells have the fields of a single process, byte by byte.
/// cells    [inputs] of the model, MomentReport::cells
/// volumes  [inputs] this rank's part of each; empty ones are removed
void add_own_values(const cli::ConvertArguments& arguments,
                    std::span<const std::optional<UniformCells>> cells,
                    std::span<std::vector<Volume>* const> volumes, SharedModel& model,
                    const Ranks& ranks);

}  // namespace vog::mpi
