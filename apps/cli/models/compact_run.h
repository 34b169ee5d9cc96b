// compact_run.h: writing a compact model, and its report.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "options/output_options.h"
#include "shared/terminal.h"
#include "vog/gaussians.h"

namespace vog::cli {

/// Writes a model as .vogz and reports bytes and losses in words, unless `json`.
/// returns  the report of --json
/// throws   vog::Error as load_volumes, fit_vogz and write_vogz do; then nothing is written
nlohmann::ordered_json write_compact(const std::string& output, Gaussians model,
                                     const CompactArguments& arguments, Stages& stages, bool json);

}  // namespace vog::cli
