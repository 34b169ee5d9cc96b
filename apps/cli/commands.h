// commands.h: subcommands of vog; each function adds one with its options and help.
#pragma once

#include <CLI/CLI.hpp>

namespace vog::cli {

void add_sample(CLI::App& app);
void add_info(CLI::App& app);
void add_convert(CLI::App& app);
void add_render(CLI::App& app);
void add_compare(CLI::App& app);
void add_evaluate(CLI::App& app);
void add_view(CLI::App& app);
void add_export(CLI::App& app);
void add_voxelize(CLI::App& app);

}  // namespace vog::cli
