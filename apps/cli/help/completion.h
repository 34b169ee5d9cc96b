// completion.h: completion of the command's words in shells.
#pragma once

#include <string>
#include <vector>

#include "help/program_text.h"

namespace vog::cli {

/// Shells with a script of completion_script.
const std::vector<std::string>& completion_shells();

/// Script that completes commands, options, choices and files of a program, to be read by a shell.
/// shell  bash, zsh or fish
std::string completion_script(const ProgramText& program, const std::string& shell);

}  // namespace vog::cli
