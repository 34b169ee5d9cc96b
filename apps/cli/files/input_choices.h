// input_choices.h: how volumes and particles are read.
#pragma once

#include <optional>
#include <string>
#include <vector>

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
struct PointInputOptions {
    std::vector<std::string> columns;
    std::string value, radius = kAutoSmoothing;
    int neighbours = PointOptions{}.neighbours;
    std::optional<std::string> periodic;  ///< of --periodic; empty: the box that the data state
};

}  // namespace vog::cli
