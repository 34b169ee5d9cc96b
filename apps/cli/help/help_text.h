// help_text.h: --help with the options that most runs need, --help-all with every option.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace vog::cli {

/// Sets the formatter and --help-all of a program. Call before its subcommands are added, which
/// inherit both.
void set_help(CLI::App& app);

/// Long names of the options that --help shows of a command; empty: all of them.
const std::vector<std::string>& common_options(const std::string& command);

/// Breaks a text into lines of at most `width` letters; words longer than that stay whole.
std::vector<std::string> wrapped(const std::string& text, std::size_t width);

/// Text that help, man page and completions give for an option: the first sentence.
std::string first_sentence(const std::string& text);

/// Choices of an option that is one of a set: {"moments", "paper"}; empty for other options.
std::vector<std::string> choices_of(const CLI::Option& option);

/// Commands of a program in the order in which they were added.
std::vector<const CLI::App*> commands_of(const CLI::App& app);

/// Their names.
std::vector<std::string> command_words(const CLI::App& app);

/// Options of a command that have a name with dashes, in order, --help and --help-all included.
std::vector<const CLI::Option*> named_options(const CLI::App& command);

/// Names of an option with their dashes: "--output", "-o".
std::vector<std::string> spellings(const CLI::Option& option);
/// Those of all options of a command.
std::vector<std::string> option_words(const CLI::App& command);

}  // namespace vog::cli
