// compact_options.h: options of compact models (.vogz).
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "vog/voxel_values.h"

namespace vog::cli {

inline constexpr const char* kCompactGroup = "Compact model (.vogz)";

struct CompactArguments {
    double max_loss_db = 0;              ///< 0: none, the steps hold
    std::vector<std::string> reference;  ///< volumes that the loss is measured against
    double model_psnr_db = 0;            ///< assumed without a reference
    double step = 0, field_step = 0;     ///< 0: the defaults
    bool hierarchy = false, deflate = false;
    ValueRules values{};  ///< for the reference's voxels
};
/// Adds --max-loss, --reference, --model-psnr, --step, --field-step, --hierarchy and --deflate.
void add_compact_options(CLI::App& command, CompactArguments& arguments);

}  // namespace vog::cli
