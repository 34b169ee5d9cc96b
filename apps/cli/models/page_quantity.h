// page_quantity.h: first settings of a page or a window, from a request.
#pragma once

#include <string>
#include <vector>

#include "options/request_options.h"
#include "vog/export_html.h"

namespace vog::cli {

/// Transfer function of a model's scalar field, found as `vog render --show volume` finds it.
/// notes     receives what was chosen
/// throws    UsageError and vog::Error as `vog render` does for such options
ValueTransfer stated_transfer(PictureRequest request, const Gaussians& model,
                              const ScalarField& field, std::vector<std::string>& notes);

/// Settings of a page with this first model.
/// input     file of the model, for messages
/// notes     receives what was chosen
HtmlOptions page_settings(PictureRequest request, const Gaussians& model, const std::string& input,
                          std::vector<std::string>& notes);

}  // namespace vog::cli
