// commands.h: subcommands of vog; each function adds one with its options and help.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace vog::cli {

void add_sample(CLI::App& app);
void add_info(CLI::App& app);
void add_convert(CLI::App& app);
void add_render(CLI::App& app);
void add_compare(CLI::App& app);
void add_evaluate(CLI::App& app);
void add_view(CLI::App& app);
void add_export(CLI::App& app);
void add_serve(CLI::App& app);
void add_voxelize(CLI::App& app);
void add_doctor(CLI::App& app);
/// Adds completion and man, which print what the other commands of the program say of themselves.
void add_guides(CLI::App& app);

/// Prints the contents of files and command lines to try on them: vog FILE...
/// throws  vog::Error for files that do not exist or cannot be read
void look_at(const std::vector<std::string>& files);

}  // namespace vog::cli
