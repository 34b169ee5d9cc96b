// option_effects.h: Table of what each option needs to have an effect: a kind of input or output, or another option.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "files/inputs.h"
#include "options/parser/given_options.h"

namespace vog::cli {

/// What a command line is about, where no single option says it. Keys and values are words of the table: "input" is
/// "volumes", "models", "compact-models" (.vogz and sites), "particles" or "text" (particles in text files), "output" an extension or a kind of folder.
/// Rows on facts that are absent do not apply.
using Facts = std::map<std::string, std::string>;

/// "volumes", "models", "compact-models", "particles" or "text".
std::string input_fact(FileKind kind, const std::vector<std::string>& inputs);

/// Refuses every given option that would have no effect.
/// throws  UsageError: "--light has no effect with --show T; it works with --show volume"
void require_effects(const GivenOptions& command, const Facts& facts);

}  // namespace vog::cli
