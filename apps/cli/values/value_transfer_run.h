// value_transfer_run.h: the transfer function of a volume picture by a command's options, and notes on what was chosen.
#pragma once

#include <string>
#include <vector>

#include "shared/render_run.h"
#include "vog/picture.h"

namespace vog::cli {

/// The transfer function of --tf, --window, --band and --iso over --range or the data, with --threshold and
/// --unit-distance, by vog::choose_transfer.
/// input   file, for messages
/// notes   receives lines on what was chosen
/// throws  CLI::ValidationError for options that exclude each other, vog::Error for bands outside the data
ChosenTransfer transfer_of(const RenderArguments& arguments, const CLI::App& command,
                           const std::string& input, const ValueData& data,
                           std::vector<std::string>& notes);

}  // namespace vog::cli
