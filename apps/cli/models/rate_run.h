// rate_run.h: vog evaluate --rate-distortion: bytes against error of models and of the volume's own voxels.
#pragma once

#include <CLI/CLI.hpp>

#include "vog/rate_distortion.h"

namespace vog::cli {

struct EvaluateArguments;

/// Options of --rate-distortion.
struct RateArguments {
    bool chosen = false;
    RateDistortionOptions options;
};
/// Adds --rate-distortion and its options; others of `command` that it has no use for are refused beside it.
void add_rate_options(CLI::App& command, RateArguments& arguments);
/// Measures the volume of `arguments` and prints the results.
/// throws  vog::Error for models, levels and several volumes, and as rate_distortion does
void run_rate_distortion(EvaluateArguments& arguments);

}  // namespace vog::cli
