// man_page.h: manual pages from the texts of --help-all.
#pragma once

#include <string>

#include "help/program_text.h"

namespace vog::cli {

/// Page of a program or of one of its commands, in the language of man(7).
/// command  name of a command; empty: the program, with the list of its commands
/// throws   vog::Error for a command that it lacks, with those that it has
std::string man_page(const ProgramText& program, const std::string& command);

}  // namespace vog::cli
