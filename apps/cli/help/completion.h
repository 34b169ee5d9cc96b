// completion.h: completion of the command's words in shells.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace vog::cli {

/// Shells with a script of completion_script.
const std::vector<std::string>& completion_shells();

/// Script that completes commands, options, choices and files of a program, to be read by a shell.
/// shell  bash, zsh or fish
std::string completion_script(const CLI::App& app, const std::string& shell);

}  // namespace vog::cli
