// command_line.h: the parser of a program: help, words, and messages for wrong ones.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "help/program_text.h"

namespace vog::cli {

/// Sets the layout of help, and --help-all. Call before commands are added, which inherit both.
void set_help(CLI::App& app);

/// What a program with its commands says of itself.
ProgramText program_text(const CLI::App& app);

/// Runs the command that the words state.
/// returns  text of --help or --version; empty: a command ran
/// throws   UsageError for words that no command takes, else as the command does
std::string run_command(CLI::App& app, const std::vector<std::string>& words);

}  // namespace vog::cli
