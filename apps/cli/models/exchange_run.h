// exchange_run.h: models as files of other programs' splats, with their options and report.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "options/output_options.h"
#include "shared/terminal.h"
#include "vog/gaussians.h"

namespace vog::cli {

/// Whether an output is a file of splats or of volumetric primitives.
bool is_splat_output(const std::string& output, const SplatArguments& arguments);

/// How splats look and stand: options of the page that they share.
struct SplatLook {
    std::optional<double> extinction;  ///< none: auto_extinction of the fitted view `paper`
    std::string tf;                    ///< transfer function of the field
    std::string field;                 ///< empty: the measure itself
    bool colored = false;              ///< --tf or --field was given; otherwise all are white
    Vec3d up{0, 1, 0};                 ///< upright direction in the data
};
/// Writes a model as splats and reports what they lose in words, unless `json`.
/// returns  the report of --json
/// throws   vog::Error for a field that the model lacks, and as the writers do; then nothing is written
nlohmann::ordered_json write_exchange(const std::string& output, Gaussians model,
                                      const SplatArguments& arguments, const SplatLook& look,
                                      Stages& stages, bool json);

}  // namespace vog::cli
