// quantity_options.h: options of the quantity that a picture shows, its colour bar and its numbers.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "vog/picture.h"

namespace vog::cli {

struct QuantityArguments {
    std::string show = "T", field, range, scale = "auto", units, title, values_output;
    bool log = false, color_bar = false, axes = false, scale_bar = false;
    /// Share of the largest column below which a picture of a field shows nothing.
    double least_column = kLeastColumn;

    Show shown() const { return show_named(show); }
    bool logarithmic() const { return log || scale == "log"; }
    ScaleFit fit() const {
        return logarithmic()          ? ScaleFit::log
               : scale == "symmetric" ? ScaleFit::symmetric
               : scale == "linear"    ? ScaleFit::linear
                                      : ScaleFit::automatic;
    }
};

/// Adds --show, --field, --range and --log: what a picture shows, and a page or a window first.
void add_shown_options(CLI::App& command, QuantityArguments& arguments);
/// Adds the same, --scale, --units, --color-bar, --title and --values-out.
void add_quantity_options(CLI::App& command, QuantityArguments& arguments);

/// throws CLI::ValidationError for a missing --field, and for a range that is none
void check_quantity_options(const QuantityArguments& arguments);
/// The scale of --range, --scale and --log; none without --range.
std::optional<ColorScale> fixed_scale(const QuantityArguments& arguments);

}  // namespace vog::cli
