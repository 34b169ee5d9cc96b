// input_options.h: options by which volumes and particles are read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "options/parser/given_options.h"
#include "vog/convert_points.h"
#include "vog/voxel_values.h"

namespace vog::cli {

struct VolumeInputOptions {
    std::string grid;   ///< name or pattern with '*' and '?'; empty: the default grid
    std::string mask;   ///< name; a '*' in it stands for the match of the '*' of `grid`
    bool sum = false;   ///< densities of several volumes add up
    bool mesh = false;  ///< several volumes are levels, whatever their lattices
    bool level_set_to_fog = false;
    ValueRules values{};
    bool ones = false;  ///< every active voxel counts as 1: a measure for values of any sign
    bool refuse_several = false;  ///< as VdbOptions::refuse_several: the result is a number
};
/// Adds --grid, --mask, --combine, --level-set-to-fog,
/// --skip-nonfinite and --clip-negative.
void add_volume_options(CLI::App& command, VolumeInputOptions& options);

inline constexpr const char* kPointGroup = "Particles";
struct PointInputOptions {
    std::vector<std::string> columns;
    std::string value, radius = kAutoSmoothing;
    int neighbours = PointOptions{}.neighbours;
    std::optional<std::string> periodic;  ///< of --periodic; empty: the box that the data state
};
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
