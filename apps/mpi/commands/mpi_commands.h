// mpi_commands.h: subcommands of vog-mpi; their options are those of vog.
#pragma once

#include <CLI/CLI.hpp>

#include "ranks.h"

namespace vog::mpi {

// `ranks` must outlive `app`.
void add_convert(CLI::App& app, const Ranks& ranks);
void add_page(CLI::App& app, const Ranks& ranks);
void add_render(CLI::App& app, const Ranks& ranks);
void add_evaluate(CLI::App& app, const Ranks& ranks);

}  // namespace vog::mpi
