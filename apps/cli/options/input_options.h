// input_options.h: options by which volumes and particles are read.
#pragma once

#include <string>
#include <vector>

#include "files/input_choices.h"
#include "options/parser/given_options.h"

namespace vog::cli {

/// Adds --grid, --mask, --combine, --level-set-to-fog,
/// --skip-nonfinite and --clip-negative.
void add_volume_options(CLI::App& command, VolumeInputOptions& options);

inline constexpr const char* kPointGroup = "Particles";
/// Adds --columns, --value, --radius, --neighbours and --periodic, as the group kPointGroup.
void add_point_options(CLI::App& command, PointInputOptions& options);

/// Inputs of a command that writes models: models, or volumes and particles that become models.
struct ModelArguments {
    std::vector<std::string> inputs;
    std::string output;
    VolumeInputOptions volume;
    PointInputOptions points;
    std::size_t budget = 0;  ///< largest number of Gaussians; 0: all
    bool no_fields = false;
    int threads = 0;
    bool json = false, verbose = false;
};

}  // namespace vog::cli
