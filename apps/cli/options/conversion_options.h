// conversion_options.h: options of both conversion methods, and their checks.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "shared/convert_run.h"

namespace vog::cli {

inline constexpr const char* kMomentGroup = "Conversion by moments (--method moments)";

void add_paper_options(CLI::App& command, ConvertArguments& arguments);
void add_moment_options(CLI::App& command, ConvertArguments& arguments);

/// Library options from the command line. throws CLI::ValidationError for options that exclude each
/// other
PaperOptions paper_options(const ConvertArguments& arguments, const CLI::App& command);
MomentOptions moment_options(const ConvertArguments& arguments, const CLI::App& command);
/// The option given that chooses the cut: --block, --budget, --error or --lod; empty: none of them.
/// throws CLI::ValidationError where two are given
std::string cut_option(const CLI::App& command);
/// throws CLI::ValidationError for options of the other method or of other inputs, which would have
/// no effect
void check_options(const ConvertArguments& arguments, const CLI::App& command, FileKind kind);

}  // namespace vog::cli
