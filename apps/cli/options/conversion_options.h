// conversion_options.h: options of conversions, made from the library's table (vog/conversion_schema.h).
#pragma once

#include <string>

#include "options/parser/given_options.h"
#include "vog/conversion_schema.h"

namespace vog::cli {

/// Adds the options of conversions but for those of particles (add_point_options).
/// of_page  those of vog-mpi page: by moments, without fits to pictures
void add_conversion_options(CLI::App& command, ConversionOptions& options, bool of_page = false);

/// Name of an option by its key: "--set.mass-threshold", "--for"; its text, with options so spelled.
std::string conversion_option(const std::string& key);
std::string conversion_text(const std::string& key);

}  // namespace vog::cli
