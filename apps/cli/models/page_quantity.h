// page_quantity.h: options of what a page or the window shows first.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "options/color_options.h"
#include "options/quantity_options.h"
#include "options/value_options.h"
#include "pictures/drawing_options.h"
#include "vog/export_html.h"

namespace vog::cli {

struct PageQuantityArguments : ClipArguments {
    QuantityArguments quantity;
    ValueArguments value;
};

/// Adds --show, --field, --range, --log, --clip, --clip-plane, and the options of volume rendering.
void add_page_quantity_options(CLI::App& command, PageQuantityArguments& arguments,
                               const std::string& group);

/// Quantity by the options, without a transfer function of values.
/// throws  CLI::ValidationError as `vog render` does for such options
HtmlQuantity stated_quantity(const PageQuantityArguments& arguments);
/// Transfer function of a model's scalar field, found as `vog render --show volume` finds it.
/// notes     receives what was chosen
/// throws    CLI::ValidationError and vog::Error as `vog render` does for such options
ValueTransfer stated_transfer(const PageQuantityArguments& arguments, const ColorArguments& color,
                              const Gaussians& model, const ScalarField& field,
                              std::vector<std::string>& notes);

/// Quantity of a page's first model: both.
/// input     file of the model, for messages
HtmlQuantity page_quantity(const PageQuantityArguments& arguments, const ColorArguments& color,
                           const Gaussians& model, const std::string& input,
                           std::vector<std::string>& notes);

}  // namespace vog::cli
