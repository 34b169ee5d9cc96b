// part_fields.h: fields of a distributed model, each rank's at its part of the voxels.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model_file.h"
#include "ranks.h"
#include "shared/convert_run.h"
#include "vog/convert_moments.h"

namespace vog::mpi {

/// Adds the fields of --field and the volumes' own values to this rank's Gaussians of every input, with the ranges of
/// all ranks, and describes them in the header. Uniform hard cells have the fields of a single process, byte by
/// byte, unless tiles are divided because a field varies inside.
/// cells    [inputs] of the model, MomentReport::cells
/// volumes  [inputs] this rank's part of each; empty ones are removed
/// returns  notes on fields that cover a part of an input alone
std::vector<std::string> add_part_fields(const cli::ConvertArguments& arguments,
                                         std::span<const std::optional<UniformCells>> cells,
                                         std::span<std::vector<Volume>* const> volumes,
                                         SharedModel& model, const Ranks& ranks);

}  // namespace vog::mpi
