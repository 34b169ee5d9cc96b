// conversion_options.h: what is asked of a conversion, in words.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "shared/convert_run.h"

namespace vog::cli {

void add_paper_options(CLI::App& command, ConvertArguments& arguments);
void add_moment_options(CLI::App& command, ConvertArguments& arguments);

/// What the words mean. throws CLI::ValidationError for options that exclude each other
PaperOptions paper_options(const ConvertArguments& arguments, const CLI::App& command);
MomentOptions moment_options(const ConvertArguments& arguments, const CLI::App& command);
/// Which of the ways to choose cells is asked for: "--budget", ...; empty: none.
std::string cut_option(const CLI::App& command);
/// Options for other inputs or the other method would be ignored: refused.
void check_options(const ConvertArguments& arguments, const CLI::App& command, FileKind kind);

}  // namespace vog::cli
