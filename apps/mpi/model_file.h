// model_file.h: parallel output of a distributed model: one PLY by MPI-IO, or one PLY per rank.
#pragma once

#include <string>
#include <vector>

#include "conversion/convert_run.h"
#include "ranks.h"

namespace vog::mpi {

/// A model distributed over the ranks.
struct SharedModel {
    /// This rank's Gaussians of each input. Order in the file: by input, then by rank.
    std::vector<Gaussians> inputs;
    /// Header of the whole model, without Gaussians; the root's is written.
    Gaussians description;
};

/// Writes one PLY through MPI-IO, under a temporary name and renamed when complete.
/// returns  figures for the report
cli::Converted write_model(const std::string& file, const SharedModel& model, const Ranks& ranks);
/// Writes model.0.ply, model.1.ply, ..., one for each rank that has Gaussians, and their index
/// model.json, where `file` is model.ply.
cli::Converted write_split(const std::string& file, const SharedModel& model, const Ranks& ranks);

}  // namespace vog::mpi
