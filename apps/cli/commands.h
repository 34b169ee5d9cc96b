// commands.h: the subcommands of vog. Each adds itself, its options and its help to the command
// line.
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

}  // namespace vog::cli
