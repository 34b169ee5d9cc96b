// page_quantity.h: the first quantity of a page or a window, from a request.
#pragma once

#include <string>
#include <vector>

#include "options/request_options.h"
#include "vog/export_html.h"

namespace vog::cli {

/// Quantity of a request, without a transfer function of values.
/// throws  UsageError for what pages do not have
HtmlQuantity stated_quantity(const PictureRequest& request);
/// Transfer function of a model's scalar field, found as `vog render --show volume` finds it.
/// notes     receives what was chosen
/// throws    UsageError and vog::Error as `vog render` does for such options
ValueTransfer stated_transfer(PictureRequest request, const Gaussians& model,
                              const ScalarField& field, std::vector<std::string>& notes);

/// Quantity of a page's first model: both.
/// input     file of the model, for messages
HtmlQuantity page_quantity(const PictureRequest& request, const Gaussians& model,
                           const std::string& input, std::vector<std::string>& notes);

}  // namespace vog::cli
