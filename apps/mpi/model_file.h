// model_file.h: one model, of which every rank has a part, in one file or in one for each rank.
#pragma once

#include <string>
#include <vector>

#include "ranks.h"
#include "shared/convert_run.h"

namespace vog::mpi {

/// The model as vog convert would make it, from what is of it here.
struct SharedModel {
    /// Of each input this rank's Gaussians; in the file, input by input, and of each rank by rank.
    std::vector<Gaussians> inputs;
    /// What the header says of the whole: the first rank's counts.
    Gaussians description;
};

/// Writes one PLY through MPI-IO, beside the file and renamed when whole.
/// returns  what was written, on the first rank
cli::Converted write_model(const std::string& file, const SharedModel& model, const Ranks& ranks);
/// Writes a PLY for each rank that has Gaussians, and their index as model.json beside model.ply.
cli::Converted write_split(const std::string& file, const SharedModel& model, const Ranks& ranks);

}  // namespace vog::mpi
