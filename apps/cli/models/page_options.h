// page_options.h: options of pages and sites: texts, names, the first view and its colours.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "models/page_quantity.h"
#include "options/camera_options.h"
#include "vog/export_html.h"

namespace vog::cli {

inline constexpr const char* kPageGroup = "Page (.html)";

struct PageArguments {
    std::vector<std::string> names;
    std::string title, description;
    RequestWords words;  ///< quantity, colours and clip
    ViewArguments view;
    bool precise = false;                ///< whether words are finer
    bool steps = false;                  ///< whether models are steps in time
    std::optional<HtmlQuantity> chosen;  ///< of a sequence's first page
    std::optional<Subject> subject;      ///< of all models, in place of one: one camera for many
};

/// Adds --title, --description, --name, --precise, --steps, and the options of quantities and colours. Those of views
/// (add_view_options) are apart.
void add_page_options(CLI::App& command, PageArguments& arguments);

/// Request of --show and the options beside it; of pages whose background is the reader's, black.
/// throws  CLI::ValidationError for words that are none
PictureRequest page_request(const PageArguments& arguments);
/// Options of a page.
/// first   the page's first model
/// input   its file, for messages
/// notes   receives what was chosen
/// throws  CLI::ValidationError and vog::Error for options that the model has no use for
HtmlOptions page_options(const PageArguments& arguments, const CLI::App& command,
                         const HtmlModel& first, const std::string& input,
                         std::vector<std::string>& notes);
/// throws  CLI::ValidationError and vog::Error, as page_options, for options that are wrong whatever the model
void check_page_options(const PageArguments& arguments, const CLI::App& command);
/// throws  CLI::ValidationError unless --name names every model or none
void check_names(const PageArguments& arguments, std::size_t models);
/// Name of model n: of --name, or that of its file without folder and extension, for people.
std::string model_name(const PageArguments& arguments, const std::string& file, std::size_t n);

}  // namespace vog::cli
