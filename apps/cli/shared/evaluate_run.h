// evaluate_run.h: arguments and hooks of an evaluation; shared by vog and vog-mpi.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "shared/inputs.h"
#include "vog/evaluate.h"

namespace vog::cli {

struct EvaluateArguments {
    std::vector<std::string> inputs;
    std::vector<std::string> models;  ///< taken out of the inputs
    std::vector<std::string> fields;  ///< texts of --field
    std::vector<std::string> tfs;     ///< texts of --tf
    std::string show = "T";
    std::string folder, size = "512x512", extinction = "auto";
    VolumeInputOptions volume;
    EvaluateOptions options;
    int threads = 0;
    bool json = false, verbose = false;
};

/// Hooks for an evaluation by several MPI ranks; the defaults are a single process.
struct EvaluateRanks {
    const Collective* collective = nullptr;  ///< reductions over the ranks; null: one process
    /// Reads this rank's part of volumes whose densities add up. Empty: the whole inputs are read.
    std::function<LoadedVolumes(const EvaluateArguments&)> load{};
};

}  // namespace vog::cli
