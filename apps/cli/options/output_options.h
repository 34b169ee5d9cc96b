// output_options.h: options that vog page, pack and export share: inputs, pages, rounding.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "options/camera_options.h"
#include "options/input_options.h"
#include "options/request_options.h"
#include "vog/export_html.h"

namespace vog::cli {

/// Adds the inputs, --output, --budget, and the options of volumes, particles and runs.
/// output  help of --output
void add_model_options(CLI::App& command, ModelArguments& arguments, const std::string& output);
/// Adds --no-fields.
void add_no_fields_option(CLI::App& command, bool& no_fields);

inline constexpr const char* kPageGroup = "Page";

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
/// Adds --title, --set description, --name, --precise, --steps, and the options of quantities and colours. Those of views
/// (add_view_options) are apart.
void add_page_options(CLI::App& command, PageArguments& arguments);

/// Steps to which numbers are rounded; 0: the default.
struct RoundingArguments {
    double step = 0, field_step = 0;
};
/// Adds the settings rounding and field-rounding.
void add_rounding_options(CLI::App& command, RoundingArguments& arguments);

}  // namespace vog::cli
