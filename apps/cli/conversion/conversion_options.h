// conversion_options.h: options of both conversion methods, and their checks.
#pragma once

#include <string>

#include "conversion/convert_run.h"
#include "options/option_effects.h"

namespace vog::cli {

inline constexpr const char* kMomentGroup = "Conversion by moments (--method moments)";

void add_paper_options(CLI::App& command, ConvertArguments& arguments);
void add_moment_options(CLI::App& command, ConvertArguments& arguments);

/// Library options from the command line. throws UsageError for --budget of a sum of volumes
PaperOptions paper_options(const ConvertArguments& arguments);
MomentOptions moment_options(const ConvertArguments& arguments);
/// The option given that chooses the cut: --block, --budget, --error or --lod; empty: none of them.
std::string cut_option(const GivenOptions& command);
/// Facts by which options of conversions have an effect, beside "output".
Facts conversion_facts(const ConvertArguments& arguments, const GivenOptions& command,
                       FileKind kind);

}  // namespace vog::cli
