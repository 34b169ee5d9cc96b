// value_options.h: options of volume rendering by value: presets of transfer functions, unit distance and light.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "vog/value_transfer.h"
#include "vog/volume_picture.h"

namespace vog::cli {

struct ValueArguments {
    std::string window;
    std::vector<std::string> bands, isos;
    std::optional<double> threshold, unit_distance;
    std::string light, light_weights;
    std::optional<int> slabs;
};

/// Adds --window, --band, --iso, --threshold, --unit-distance, --light, --light-weights and --slabs.
void add_value_options(CLI::App& command, ValueArguments& arguments);

/// throws CLI::ValidationError for texts and numbers that are none
void check_value_options(const ValueArguments& arguments);

/// Centre and width of --window; none without it.
std::optional<std::pair<double, double>> window_of(const ValueArguments& arguments);
/// Bands of --band and --iso, sorted; a band of --iso ends where the next one begins, the last one nowhere.
std::vector<ValueBand> bands_of(const ValueArguments& arguments);
/// Light of --light and --light-weights.
VolumeLook look_of(const ValueArguments& arguments);

}  // namespace vog::cli
