// evaluate_run.h: what vog evaluate and vog-mpi evaluate share.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "shared/inputs.h"
#include "vog/evaluate.h"

namespace vog::cli {

struct EvaluateArguments {
    std::vector<std::string> inputs;
    std::string folder, size = "512x512", extinction = "auto";
    VolumeInputOptions volume;
    EvaluateOptions options;
    int threads = 0;
    bool json = false, verbose = false;
};

/// Several who evaluate together.
struct EvaluateTogether {
    const Collective* collective = nullptr;  ///< processes that share the work; null: one
    /// Reads this one's part of volumes that add up; empty: all of them, or levels, are read.
    std::function<std::vector<Volume>(const EvaluateArguments&)> load{};
};
/// Adds the subcommand.
void add_evaluate(CLI::App& app, const std::shared_ptr<EvaluateArguments>& arguments,
                  const EvaluateTogether& others);

}  // namespace vog::cli
