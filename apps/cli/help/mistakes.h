// mistakes.h: messages for wrong usage that state the remedy.
#pragma once

#include <string>
#include <vector>

#include "help/program_text.h"

namespace vog::cli {

/// Smallest number of letters inserted, removed, replaced or swapped with their neighbour that turn
/// one word into the other (optimal string alignment).
std::size_t edit_distance(const std::string& a, const std::string& b);

/// The word of a list that is nearest to a mistyped one: at most a third of its letters differ, or
/// it begins with them. Empty: none is near.
std::string nearest(const std::string& word, const std::vector<std::string>& known);

/// Message for a word that is neither a command nor a file: "no command or file 'rendr'; did you mean
/// 'render'?"
std::string unknown_command_text(const ProgramText& program, const std::string& word);

/// Message for words that no option and no argument of a command takes.
/// command  empty: none was stated
std::string unexpected_text(const ProgramText& program, const std::string& command,
                            const std::vector<std::string>& words);

/// Message for a command whose -o is missing, with a whole command line.
std::string missing_output_text(const std::string& program, const std::string& command,
                                const std::string& input);

/// A failure's message with the remedy that the command has for it: where its list of grids looks like the levels of a mesh,
/// "...; --grid 'density_L*' reads all of them as levels"; of signed values, --show volume.
std::string with_remedy(const std::string& message);

}  // namespace vog::cli
