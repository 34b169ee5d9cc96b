// commands.h: the subcommands of vog-mpi, with the options of vog's.
#pragma once

#include <CLI/CLI.hpp>

#include "ranks.h"

namespace vog::mpi {

// ranks outlives the command line.
void add_convert(CLI::App& app, const Ranks& ranks);
void add_render(CLI::App& app, const Ranks& ranks);
void add_evaluate(CLI::App& app, const Ranks& ranks);

}  // namespace vog::mpi
