// page_options.h: options of pages and sites: texts, names, the first view and its colours.
#pragma once

#include <string>
#include <vector>

#include "models/page_quantity.h"
#include "options/output_options.h"
#include "vog/export_html.h"

namespace vog::cli {

/// Request of --show and the options beside it; of pages whose background is the reader's, black.
/// throws  UsageError for words that are none
PictureRequest page_request(const PageArguments& arguments);
/// Options of a page.
/// first   the page's first model
/// input   its file, for messages
/// notes   receives what was chosen
/// throws  UsageError and vog::Error for options that the model has no use for
HtmlOptions page_options(const PageArguments& arguments, const GivenOptions& command,
                         const HtmlModel& first, const std::string& input,
                         std::vector<std::string>& notes);
/// throws  UsageError and vog::Error, as page_options, for options that are wrong whatever the model
void check_page_options(const PageArguments& arguments, const GivenOptions& command);
/// throws  UsageError unless --name names every model or none
void check_names(const PageArguments& arguments, std::size_t models);
/// Name of model n: of --name, or that of its file without folder and extension, for people.
std::string model_name(const PageArguments& arguments, const std::string& file, std::size_t n);

}  // namespace vog::cli
